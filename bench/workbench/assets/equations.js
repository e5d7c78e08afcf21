"use strict";
/*
The normal equations of the page's data, for any effects: a second writing of bench/estimate (weighted least squares, then
the current's error), on inner products in place of rows.

The torque of a model is columns d + known + g0 modelled: `modelled` is the current of the found model, g0 its gains, d
how the parameters differ from it, and `known` takes out the found model's effects that are not ticked. A motor's current
error is then error + (1 - g0/g) modelled - (columns d + known)/g, which loses no digits near the found model.
*/
const WorkbenchEquations = (() => {
  const {product, times, factorised, solved} = WorkbenchNumbers;
  const REWEIGHTINGS = 3;
  const MOST_STEPS = 50;
  const CONVERGED = 1e-12;
  const DEPENDENT = 1e-10; // of a column's square: what the others must leave of it
  const TINY = 1e-300;

  function create(data, columns) {
    const {motors, reference, mapOf, combined} = columns;
    const n = data.motors.length;
    const own = data.own;
    const fitGains = data.fits_gains;
    const foundGains = columns.found.gains;
    const nominal = data.motors.map((motor) => motor.nominal);
    const squares = {
      fitted: data.motors.map((motor) => motor.fitted.squares),
      judged: data.motors.map((motor) => motor.judged.squares),
    };

    function systemOf(terms, present) {
      const {columns, p} = mapOf(terms, present);
      const start = new Float64Array(p);
      start.set(reference.subarray(0, own));
      return {terms, columns, p, K: p + 3, start, fitted: motors.map((one) => combined(one, one.fitted, columns))};
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

    function errors(grams, K, d, gains) {
      return grams.map((gram, j) => {
        const x = errorVector(K, d, gains[j], j);
        return Math.max(product(gram, K, x, x), 0);
      });
    }

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
        for (let a = 0; a < p; a++) for (let b = 0; b < p; b++) gram[at(a) * size + at(b)] += one[a * K + b];
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
      const {passed} = factorised(gram, size, DEPENDENT);
      for (let i = own + 1; i < size; i++) if (!passed[i]) order.push(i - 1);
      return order;
    }

    function taken(gram, K, index) {
      const size = index.length;
      const found = new Float64Array(size * size);
      for (let a = 0; a < size; a++) for (let b = 0; b < size; b++) found[a * size + b] = gram[index[a] * K + index[b]];
      return found;
    }

    /* Least squares of the torque's error with given weights. */
    function linear(grams, K, weights) {
      const k = K - 3;
      const size = k + (fitGains ? n : 0);
      const normal = new Float64Array(size * size);
      const right = new Float64Array(size);
      grams.forEach((gram, j) => {
        const w = weights[j] ** 2;
        const aim = new Float64Array(K);
        aim[k] = -1;
        aim[k + 1] = fitGains ? 0 : nominal[j] - foundGains[j];
        aim[k + 2] = fitGains ? foundGains[j] : nominal[j];
        const cross = times(gram, K, aim);
        for (let a = 0; a < k; a++) {
          for (let b = 0; b < k; b++) normal[a * size + b] += w * gram[a * K + b];
          right[a] += w * cross[a];
        }
        if (!fitGains) return;
        const current = new Float64Array(K);
        current[k + 1] = current[k + 2] = 1;
        const by = times(gram, K, current);
        for (let a = 0; a < k; a++) normal[a * size + k + j] = normal[(k + j) * size + a] = -w * by[a];
        normal[(k + j) * size + k + j] = w * (by[k + 1] + by[k + 2]);
        right[k + j] = -w * (cross[k + 1] + cross[k + 2]);
      });
      const x = solved(factorised(normal, size), right);
      return {d: x.slice(0, k), gains: fitGains ? foundGains.map((g, j) => g + x[k + j]) : nominal.slice()};
    }

    /* The linearised current errors: normal matrix and right side for [d, gains]. */
    function linearisedStep(grams, K, d, gains, weights) {
      const k = d.length;
      const size = k + (fitGains ? n : 0);
      const normal = new Float64Array(size * size);
      const right = new Float64Array(size);
      const byGain = [];
      grams.forEach((gram, j) => {
        const w = weights[j] ** 2;
        const g = gains[j];
        const cross = times(gram, K, errorVector(K, d, g, j));
        for (let a = 0; a < k; a++) {
          for (let b = 0; b < k; b++) normal[a * size + b] += (w / (g * g)) * gram[a * K + b];
          right[a] += (w / g) * cross[a];
        }
        const y = new Float64Array(K);
        for (let i = 0; i < k; i++) y[i] = -d[i] / (g * g);
        y[K - 3] = -1 / (g * g);
        y[K - 2] = -foundGains[j] / (g * g);
        byGain.push(y);
        if (!fitGains) return;
        const by = times(gram, K, y);
        let square = 0;
        let against = 0;
        for (let a = 0; a < K; a++) {
          square += y[a] * by[a];
          against += y[a] * cross[a];
        }
        for (let a = 0; a < k; a++) normal[a * size + k + j] = normal[(k + j) * size + a] = (w / g) * by[a];
        normal[(k + j) * size + k + j] = w * square;
        right[k + j] = w * against;
      });
      return {normal, right, size, byGain};
    }

    function minimised(grams, K, from, weights) {
      let {d, gains} = from;
      const k = d.length;
      const costOf = (values, by) => errors(grams, K, values, by).reduce((sum, one, j) => sum + one * weights[j] ** 2, 0);
      let cost = costOf(d, gains);
      for (let round = 0; round < MOST_STEPS; round++) {
        const {normal, right, size} = linearisedStep(grams, K, d, gains, weights);
        const step = solved(factorised(normal, size), right);
        let change = 0;
        if (fitGains) gains.forEach((g, j) => (change = Math.max(change, Math.abs(step[k + j] / g))));
        let share = 1 / Math.max(1, 2 * change);
        let next = null;
        while (share > 1e-6) {
          const tried = d.map((value, i) => value + share * step[i]);
          const by = fitGains ? gains.map((g, j) => g + share * step[k + j]) : gains;
          const reached = costOf(tried, by);
          if (reached <= cost * (1 + 1e-12)) {
            next = {d: tried, gains: by, cost: reached};
            break;
          }
          share /= 2;
        }
        if (!next) break;
        const settled = cost - next.cost <= CONVERGED * cost && share === 1;
        ({d, gains, cost} = next);
        if (settled) break;
      }
      return {d, gains};
    }

    /* The current-domain solution of a system; from: a solution nearby, {d, gains}, at which to begin. */
    function solve(system, from = null) {
      const kept = keptColumns(system);
      const {p, K: whole} = system;
      const index = [...kept, p, p + 1, p + 2];
      const K = index.length;
      const grams = system.fitted.map((gram) => taken(gram, whole, index));
      const largest = Math.sqrt(Math.max(...squares.fitted.map((one) => one / data.rows)));
      const torqueWeights = (at) => {
        const scale = Math.max(...at.gains.map((g, j) => Math.sqrt(squares.fitted[j] / data.rows) * Math.abs(g)));
        return torqueErrors(grams, K, at.d, at.gains).map((one) => 1 / Math.max(Math.sqrt(one / data.rows), 1e-9 * scale + TINY));
      };
      const currentWeights = (at) =>
        errors(grams, K, at.d, at.gains).map((one) => 1 / Math.max(Math.sqrt(one / data.rows), 1e-9 * largest + TINY));
      let at = from && {d: Float64Array.from(kept, (column) => from.d[column]), gains: from.gains};
      if (!from) {
        at = linear(grams, K, new Array(n).fill(1));
        for (let i = 0; i < REWEIGHTINGS; i++) at = linear(grams, K, torqueWeights(at));
      }
      let weights = currentWeights(at);
      for (let i = from ? 1 : 0; i < REWEIGHTINGS; i++) {
        at = minimised(grams, K, at, weights);
        weights = currentWeights(at);
      }
      const d = new Float64Array(p);
      const theta = new Float64Array(p);
      kept.forEach((column, i) => {
        d[column] = at.d[i];
        theta[column] = at.d[i] + system.start[column];
      });
      return {d, theta, gains: at.gains, kept};
    }

    /* What an effect's columns explain beside a solved system: Schur complements (b, b) and (b,). */
    function besides(system, solution, place) {
      const {K} = system;
      const b = place.size;
      const all = [...system.columns];
      for (let i = 0; i < b; i++) all.push({index: [place.start + i], value: [1]});
      const size = all.length;
      const {d, gains} = solution;
      const rms = errors(system.fitted, K, d, gains).map((one, j) => Math.sqrt(one / Math.max(data.motors[j].fitted.moving, 1)));
      const floor = 1e-12 * Math.max(...rms) + TINY;
      const weights = rms.map((one) => 1 / Math.max(one, floor));
      const {normal, right, size: unknowns, byGain} = linearisedStep(system.fitted, K, d, gains, weights);
      const inner = new Float64Array(b * b);
      const score = new Float64Array(b);
      const cross = Array.from({length: b}, () => new Float64Array(unknowns));
      motors.forEach((motor, j) => {
        if (place.motor >= 0 && j !== place.motor) return; // its columns are zero there
        const gram = combined(motor, motor.fitted, all);
        const w = weights[j] ** 2;
        const g = gains[j];
        const error = errorVector(K, d, g, j);
        for (let i = 0; i < b; i++) {
          const row = gram.subarray((K + i) * size, (K + i + 1) * size);
          for (let m = 0; m < b; m++) inner[i * b + m] += (w / (g * g)) * row[K + m];
          let along = 0;
          let gain = 0;
          for (let a = 0; a < K; a++) {
            along += row[a] * error[a];
            gain += row[a] * byGain[j][a];
          }
          score[i] += (w / g) * along;
          for (let a = 0; a < d.length; a++) cross[i][a] += (w / (g * g)) * row[a];
          if (fitGains) cross[i][d.length + j] += (w / g) * gain;
        }
      });
      const factor = factorised(normal, unknowns);
      const explained = solved(factor, right);
      for (let i = 0; i < b; i++) {
        const x = solved(factor, cross[i]);
        for (let a = 0; a < unknowns; a++) score[i] -= cross[i][a] * explained[a];
        for (let m = 0; m < b; m++) {
          let sum = 0;
          for (let a = 0; a < unknowns; a++) sum += cross[m][a] * x[a];
          inner[m * b + i] -= sum;
        }
      }
      return {inner, score};
    }

    /* How the page's columns are combined beside the found model (C,), for curves. */
    function differenceOf(system, solution) {
      const sum = new Float64Array(reference.length);
      system.columns.slice(0, system.p + 1).forEach(({index, value}, k) => {
        const share = k < system.p ? solution.d[k] : 1;
        if (share !== 0) index.forEach((at, i) => (sum[at] += share * value[i]));
      });
      return sum;
    }

    return {systemOf, errors, solve, besides, differenceOf, squares};
  }

  return {create};
})();
