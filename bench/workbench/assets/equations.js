"use strict";
/*
The normal equations of the page's data, for any effects: a second writing of bench/identification (weighted least squares, then
the current's error), on inner products in place of rows.

The torque of a model is columns d + known + g0 modelled: `modelled` is the current of the found model, g0 its gains, d
how the model's own parameters differ from it, or an effect's values; `known` takes all found effects out. A motor's current
error is then error + (1 - g0/g) modelled - (columns d + known)/g, which loses no digits near the found model.
*/
const WorkbenchEquations = (() => {
  const {doubles, triangleOf, gramOf, product, times, factorised, solved} = WorkbenchNumbers; // of symmetric matrices, `factorised` reads the lower half
  const REWEIGHTINGS = 3;
  const MOST_STEPS = 50;
  const CONVERGED = {exact: 1e-13, short: 1e-10}; // of the cost: what a further step would gain
  const DEPENDENT = {exact: 4e-10, short: 1e-7}; // of a column's square: what others must leave of it
  const TINY = 1e-300;

  /* A motor's inner products of [the page's columns that it has, known, modelled, error]; place: of a column there. */
  function motorOf(data, motor, reference) {
    const count = motor.columns.length;
    const place = new Int32Array(data.columns + 3).fill(-1);
    motor.columns.forEach((column, i) => (place[column] = i));
    for (let i = 0; i < 3; i++) place[data.columns + i] = count + i;
    const known = new Float64Array(count + 2);
    motor.columns.forEach((column, i) => (known[i] = column < data.own ? 0 : -reference[column]));
    const gram = (use) => withKnown(gramOf(triangleOf(motor[use].triangle, count + 2), count + 2), count + 2, known);
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
    const n = data.motors.length;
    const {own} = data;
    const reference = doubles(data.reference);
    const motors = data.motors.map((motor) => motorOf(data, motor, reference));
    const fitGains = data.fits_gains;
    const digits = data.short ? "short" : "exact"; // numbers of 16 bits tell no finer
    const foundGains = data.motors.map((motor) => motor.gain);
    const nominal = data.motors.map((motor) => motor.nominal);
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
      const start = new Float64Array(p);
      start.set(reference.subarray(0, own));
      return {index, p, K: p + 3, start, fitted: gramsOf("fitted", index)};
    }

    /* A current error as a combination of [columns, known, modelled, error]. */
    function errorVector(K, d, gain, j) {
      const x = new Float64Array(K);
      for (let i = 0; i < d.length; i++) x[i] = -d[i] / gain;
      x[K - 3] = -1 / gain;
      x[K - 2] = 1 - foundGains[j] / gain;
      x[K - 1] = 1;
      return x;
    }

    /* Each motor's error x'x as a combination x of the columns, and its inner products with all of them. */
    function left(grams, K, d, gains) {
      return grams.map((gram, j) => {
        const x = errorVector(K, d, gains[j], j);
        const cross = times(gram, K, x);
        let square = 0;
        for (let i = 0; i < K; i++) square += x[i] * cross[i];
        return {x, cross, square: Math.max(square, 0)};
      });
    }

    const errors = (grams, K, d, gains) => left(grams, K, d, gains).map((one) => one.square);

    function torqueErrors(grams, K, d, gains) {
      return grams.map((gram, j) => {
        const x = new Float64Array(K);
        for (let i = 0; i < d.length; i++) x[i] = -d[i];
        x[K - 3] = -1;
        x[K - 2] = gains[j] - foundGains[j];
        x[K - 1] = gains[j];
        return Math.max(product(gram, K, x, x), 0);
      });
    }

    /* Which columns are told apart from those before them; the payload's torque counts where the gains are unknown. */
    function keptColumns(system) {
      const {p, K} = system;
      const order = [];
      for (let i = 0; i < own; i++) order.push(i);
      if (p === own) return order;
      const size = p + 1;
      const gram = new Float64Array(size * size);
      system.fitted.forEach((one, j) => {
        const kappa = new Float64Array(K);
        for (let i = 0; i < p; i++) kappa[i] = -system.start[i];
        kappa[K - 3] = 1;
        kappa[K - 2] = foundGains[j];
        const cross = times(one, K, kappa);
        const at = (i) => (i < own ? i : i + 1); // the payload stands after the model's own columns
        for (let a = 0; a < p; a++) for (let b = 0; b <= a; b++) gram[at(a) * size + at(b)] += one[a * K + b];
        for (let a = 0; a < p; a++) {
          gram[at(a) * size + own] += cross[a];
          gram[own * size + at(a)] += cross[a];
        }
        gram[own * size + own] += product(one, K, kappa, kappa);
      });
      if (!fitGains) {
        for (let i = 0; i < size; i++) gram[own * size + i] = gram[i * size + own] = 0;
      }
      let largest = 0;
      for (let i = 0; i < own; i++) largest = Math.max(largest, gram[i * size + i]);
      for (let i = own + 1; i < size; i++) {
        if (gram[i * size + i] > 1e-18 * largest) continue;
        for (let k = 0; k < size; k++) gram[i * size + k] = gram[k * size + i] = 0;
      }
      const {passed} = factorised(gram, size, DEPENDENT[digits]);
      for (let i = own + 1; i < size; i++) if (!passed[i]) order.push(i - 1);
      return order;
    }

    function taken(gram, K, index) {
      const size = index.length;
      const found = new Float64Array(size * size);
      for (let a = 0; a < size; a++) for (let b = 0; b < size; b++) found[a * size + b] = gram[index[a] * K + index[b]];
      return found;
    }

    /* The system without the columns that depend on others; index: of the columns that stay. */
    function keptOnly({p, K: whole, fitted}, kept) {
      const index = [...kept, p, p + 1, p + 2];
      const K = index.length;
      return {K, grams: K === whole ? fitted : fitted.map((gram) => taken(gram, whole, index))};
    }

    /* Least squares of the torque's error with given weights. */
    function linear(grams, K, weights) {
      const k = K - 3;
      const size = k + (fitGains ? n : 0);
      const normal = new Float64Array(size * size);
      const right = new Float64Array(size);
      grams.forEach((gram, j) => {
        const w = weights[j] ** 2;
        const [modelled, error] = fitGains ? [0, foundGains[j]] : [nominal[j] - foundGains[j], nominal[j]];
        const aim = (a) => modelled * gram[a * K + k + 1] + error * gram[a * K + k + 2] - gram[a * K + k];
        for (let a = 0; a < k; a++) {
          for (let b = 0; b <= a; b++) normal[a * size + b] += w * gram[a * K + b];
          right[a] += w * aim(a);
        }
        if (!fitGains) return;
        const current = (a) => gram[a * K + k + 1] + gram[a * K + k + 2];
        for (let a = 0; a < k; a++) normal[(k + j) * size + a] = -w * current(a);
        normal[(k + j) * size + k + j] = w * (current(k + 1) + current(k + 2));
        right[k + j] = -w * (aim(k + 1) + aim(k + 2));
      });
      const x = solved(factorised(normal, size), right);
      return {d: x.slice(0, k), gains: fitGains ? foundGains.map((g, j) => g + x[k + j]) : nominal.slice()};
    }

    /* The linearised current errors: normal matrix and right side for [d, gains]; at: what is left there. */
    function linearisedStep(grams, K, d, gains, weights, at) {
      const k = d.length;
      const size = k + (fitGains ? n : 0);
      const normal = new Float64Array(size * size);
      const right = new Float64Array(size);
      const byGain = [];
      grams.forEach((gram, j) => {
        const w = weights[j] ** 2;
        const g = gains[j];
        const {x, cross} = at[j];
        const scale = w / (g * g);
        for (let a = 0; a < k; a++) {
          for (let b = 0; b <= a; b++) normal[a * size + b] += scale * gram[a * K + b];
          right[a] += (w / g) * cross[a];
        }
        const y = x.map((value, i) => (i < K - 2 ? value : value - 1) / g); // how the error changes with the gain
        byGain.push(y);
        if (!fitGains) return;
        let square = 0;
        let against = 0;
        for (let a = 0; a < K; a++) {
          const by = (cross[a] - gram[a * K + K - 2] - gram[a * K + K - 1]) / g;
          square += y[a] * by;
          against += y[a] * cross[a];
          if (a < k) normal[(k + j) * size + a] = (w / g) * by;
        }
        normal[(k + j) * size + k + j] = w * square;
        right[k + j] = w * against;
      });
      return {normal, right, size, byGain};
    }

    /* from: {d, gains}, and `rate`: by which share each step gains less than the one before, as far as it is known. */
    function minimised(grams, K, from, weights) {
      let {d, gains, rate = 1} = from;
      let gained = 0;
      const k = d.length;
      const costOf = (every) => every.reduce((sum, one, j) => sum + one.square * weights[j] ** 2, 0);
      let now = left(grams, K, d, gains);
      let cost = costOf(now);
      for (let round = 0; round < MOST_STEPS; round++) {
        const {normal, right, size} = linearisedStep(grams, K, d, gains, weights, now);
        const step = solved(factorised(normal, size), right);
        let change = 0;
        if (fitGains) gains.forEach((g, j) => (change = Math.max(change, Math.abs(step[k + j] / g))));
        let share = 1 / Math.max(1, 2 * change);
        let next = null;
        while (share > 1e-6) {
          const tried = d.map((value, i) => value + share * step[i]);
          const by = fitGains ? gains.map((g, j) => g + share * step[k + j]) : gains;
          const reached = left(grams, K, tried, by);
          if (costOf(reached) <= cost * (1 + 1e-12)) {
            next = {d: tried, gains: by, cost: costOf(reached), now: reached};
            break;
          }
          share /= 2;
        }
        if (!next) break;
        if (gained > 0) rate = Math.min(1, Math.max((cost - next.cost) / gained, 0));
        gained = cost - next.cost;
        const settled = gained * rate <= CONVERGED[digits] * cost && share === 1; // what the next step would gain
        ({d, gains, cost, now} = next);
        if (settled) break;
      }
      return {d, gains, rate};
    }

    /* The current-domain solution of a system. */
    function solve(system) {
      const kept = keptColumns(system);
      const {p} = system;
      const {K, grams} = keptOnly(system, kept);
      const largest = Math.sqrt(Math.max(...squares.fitted.map((one) => one / data.rows)));
      const torqueWeights = (at) => {
        const scale = Math.max(...at.gains.map((g, j) => Math.sqrt(squares.fitted[j] / data.rows) * Math.abs(g)));
        return torqueErrors(grams, K, at.d, at.gains).map(
          (one) => 1 / Math.max(Math.sqrt(one / data.rows), 1e-9 * scale + TINY),
        );
      };
      const currentWeights = (at) =>
        errors(grams, K, at.d, at.gains).map((one) => 1 / Math.max(Math.sqrt(one / data.rows), 1e-9 * largest + TINY));
      let at = linear(grams, K, new Array(n).fill(1));
      for (let i = 0; i < REWEIGHTINGS; i++) at = linear(grams, K, torqueWeights(at));
      let weights = currentWeights(at);
      for (let i = 0; i < REWEIGHTINGS; i++) {
        at = minimised(grams, K, at, weights);
        weights = currentWeights(at);
      }
      const d = new Float64Array(p);
      kept.forEach((column, i) => (d[column] = at.d[i]));
      return {d, gains: at.gains, kept};
    }

    /* How the page's columns are combined beside the found model (C,). */
    function differenceOf({index, p}, solution) {
      const sum = reference.map((value, i) => (i < own ? 0 : -value));
      for (let k = 0; k < p; k++) sum[index[k]] += solution.d[k];
      return sum;
    }

    const judged = (system, solution) => errors(gramsOf("judged", system.index), system.K, solution.d, solution.gains);
    const fitted = (system, solution) => errors(system.fitted, system.K, solution.d, solution.gains);

    return {systemOf, solve, fitted, judged, differenceOf, squares};
  }

  return {create};
})();
