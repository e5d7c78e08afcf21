"use strict";
/*
The normal equations of the page's data, for any effects: least squares of the current's error on inner products in place
of rows, as bench/diagnosis solves a set.

The torque of a model is columns d + known + g0 modelled: `modelled` is the current of the found model, g0 its gains, d
how the model's own parameters differ from it, or an effect's values; `known` takes all found effects out. A motor's current
error is then error + (1 - g0/g) modelled - (columns d + known)/g, which loses no digits near the found model.
*/
const WorkbenchEquations = (() => {
  const {doubles, floats, gramOf, product, times, factorised, solved} = WorkbenchNumbers;
  const MOST_REWEIGHTINGS = 60;
  const SETTLED = 1e-6; // of a motor's weight: what another weighting changes
  const MOST_STEPS = 50;
  const CONVERGED = 1e-11; // of the cost: what a step gains
  const DEPENDENT = 4e-10; // of a column's square: what others must leave of it
  const TINY = 1e-300;

  /* A motor's inner products of [the page's columns that it has, known, modelled, error]; place: of a column there. */
  function motorOf(data, motor, reference) {
    const count = motor.columns.length;
    const place = new Int32Array(data.columns + 3).fill(-1);
    motor.columns.forEach((column, i) => (place[column] = i));
    for (let i = 0; i < 3; i++) place[data.columns + i] = count + i;
    const known = new Float64Array(count + 2);
    motor.columns.forEach((column, i) => (known[i] = column < data.own ? 0 : -reference[column]));
    const gram = (use) => withKnown(gramOf(floats(motor[use].triangle), count + 2), count + 2, known);
    return {place, size: count + 3, fitted: gram("fitted"), judged: gram("judged")};
  }

  /* Inner products (size + 1) with one more column before the last two: `known` says how it is combined of the others. */
  function withKnown(gram, size, known) {
    const wide = size + 1;
    const found = new Float64Array(wide * wide);
    const at = (i) => (i < size - 2 ? i : i + 1);
    for (let a = 0; a < size; a++) for (let b = 0; b < size; b++) found[at(a) * wide + at(b)] = gram[a * size + b];
    const cross = times(gram, size, known);
    for (let a = 0; a < size; a++) found[at(a) * wide + size - 2] = found[(size - 2) * wide + at(a)] = cross[a];
    found[(size - 2) * wide + size - 2] = product(gram, size, known, known);
    return found;
  }

  function create(data) {
    const {own} = data;
    const reference = doubles(data.reference);
    const motors = data.motors.map((motor) => motorOf(data, motor, reference));
    const foundGains = data.motors.map((motor) => motor.gain);
    const free = data.fits_gains ? motors.length : 0; // unknown gains; they stand behind the model's own parameters
    const placeOf = (column) => (column < own ? column : column + free);
    const squares = {
      fitted: data.motors.map((motor) => motor.fitted.squares),
      judged: data.motors.map((motor) => motor.judged.squares),
    };

    /* Inner products (K, K) of these columns for each motor; one that it does not have is zero. */
    function gramsOf(use, index) {
      const K = index.length;
      return motors.map(({place, size, [use]: gram}) => {
        const found = new Float64Array(K * K);
        const at = index.map((column) => place[column]);
        for (let a = 0; a < K; a++) {
          if (at[a] < 0) continue;
          for (let b = 0; b < K; b++) if (at[b] >= 0) found[a * K + b] = gram[at[a] * size + at[b]];
        }
        return found;
      });
    }

    /* The system with these places' columns beside the model's own. */
    function systemOf(terms) {
      const index = Array.from({length: own}, (_, i) => i);
      for (const {start, stop} of terms) for (let i = start; i < stop; i++) index.push(i);
      const p = index.length;
      for (let i = 0; i < 3; i++) index.push(data.columns + i);
      return {index, p, K: p + 3, fitted: gramsOf("fitted", index)};
    }

    /* A model (d, gains), and of each motor its error as a combination x of [columns, known, modelled, error]. */
    function modelOf(grams, K, d, gains) {
      const left = grams.map((gram, j) => {
        const x = new Float64Array(K);
        for (let i = 0; i < d.length; i++) x[i] = -d[i] / gains[j];
        x[K - 3] = -1 / gains[j];
        x[K - 2] = 1 - foundGains[j] / gains[j];
        x[K - 1] = 1;
        const cross = times(gram, K, x);
        const square = cross.reduce((sum, value, i) => sum + x[i] * value, 0);
        return {x, cross, square: Math.max(square, 0)};
      });
      return {d, gains, left, errors: left.map((motor) => motor.square)};
    }

    /* Gauss and Newton's equations about a model: unknowns are the model's own parameters, gains, effects' values. */
    function linearised({K, p, fitted: grams}, {gains, left}, weights, dropped) {
      const size = p + free;
      const normal = new Float64Array(size * size);
      const right = new Float64Array(size);
      const add = (i, k, value) => (normal[Math.max(i, k) * size + Math.min(i, k)] += value);
      grams.forEach((gram, j) => {
        const {x, cross} = left[j];
        const w = (weights[j] / gains[j]) ** 2;
        for (let a = 0; a < p; a++) {
          for (let b = 0; b <= a; b++) add(placeOf(a), placeOf(b), w * gram[a * K + b]);
          right[placeOf(a)] += w * gains[j] * cross[a];
        }
        if (!free || data.motors[j].held) return; // a column of zeros changes nothing
        for (let a = 0; a < K; a++) {
          const share = a < K - 2 ? x[a] : x[a] - 1; // of what the model gives, which is how the error follows the gain
          const by = cross[a] - gram[a * K + K - 2] - gram[a * K + K - 1];
          add(own + j, own + j, w * share * by);
          right[own + j] += w * gains[j] * share * cross[a];
          if (a < p) add(own + j, placeOf(a), w * by);
        }
      });
      for (const column of dropped) {
        for (let i = 0; i < size; i++) normal[column * size + i] = normal[i * size + column] = 0;
      }
      return {normal, right, size};
    }

    /* The model of least squared errors with these weights. */
    function minimised(system, from, weights, dropped) {
      const {K, fitted: grams} = system;
      const costOf = ({errors}) => errors.reduce((sum, square, j) => sum + square * weights[j] ** 2, 0);
      let now = from;
      for (let round = 0; round < MOST_STEPS; round++) {
        const {normal, right, size} = linearised(system, now, weights, dropped);
        const step = solved(factorised(normal, size), right);
        const change = now.gains.reduce((most, g, j) => (free ? Math.max(most, Math.abs(step[own + j] / g)) : 0), 0);
        const cost = costOf(now);
        let share = 1 / Math.max(1, 2 * change);
        let next = null;
        for (; share > 1e-6 && !next; share /= 2) {
          const d = now.d.map((value, i) => value + share * step[placeOf(i)]);
          const gains = free ? now.gains.map((g, j) => g + share * step[own + j]) : now.gains;
          const tried = modelOf(grams, K, d, gains);
          if (costOf(tried) <= cost * (1 + 1e-12)) next = tried;
        }
        if (!next) break;
        now = next;
        if (cost - costOf(now) <= CONVERGED * cost) break;
      }
      return now;
    }

    /* The solution of a system; dropped: columns that those before them make up, whose values are zero. */
    function solve(system) {
      const {K, p, fitted: grams} = system;
      const largest = Math.max(...squares.fitted);
      const weightsOf = (errors) =>
        errors.map((square) => Math.sqrt(data.rows / Math.max(square, 1e-18 * largest + TINY)));
      const gains = free ? foundGains : data.motors.map((motor) => motor.nominal);
      let weights = weightsOf(grams.map((gram) => gram[K * K - 1]));
      let now = modelOf(grams, K, new Float64Array(p), gains);
      const {normal, size} = linearised(system, now, weights, []);
      const {passed} = factorised(normal, size, DEPENDENT);
      const dropped = [];
      for (let i = own + free; i < size; i++) if (passed[i]) dropped.push(i);
      for (let i = 0; i < MOST_REWEIGHTINGS; i++) {
        now = minimised(system, now, weights, dropped);
        const before = weights;
        weights = weightsOf(now.errors);
        if (weights.every((weight, j) => Math.abs(weight / before[j] - 1) < SETTLED)) break;
      }
      return {d: now.d, gains: now.gains, absorbed: (column) => dropped.includes(placeOf(column))};
    }

    /* How the page's columns are combined beside the found model (C,). */
    function differenceOf({index, p}, solution) {
      const sum = reference.map((value, i) => (i < own ? 0 : -value));
      for (let k = 0; k < p; k++) sum[index[k]] += solution.d[k];
      return sum;
    }

    /* The squared errors that a solution leaves. */
    const left = (use, {index, K}, {d, gains}) => modelOf(gramsOf(use, index), K, d, gains).errors;

    return {systemOf, solve, left, differenceOf, squares};
  }

  return {create};
})();
