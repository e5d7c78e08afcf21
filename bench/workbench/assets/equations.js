"use strict";
/*
The normal equations of the page's data, for any effects: a second writing of bench/estimate (weighted least squares, then
the current's error), on inner products in place of rows.

The torque of a model is columns d + known + g0 modelled: `modelled` is the current of the found model, g0 its gains, d
how the parameters differ from it, and `known` takes out the found model's effects that are not ticked. A motor's current
error is then error + (1 - g0/g) modelled - (columns d + known)/g, which loses no digits near the found model.
*/
const WorkbenchEquations = (() => {
  const {product, times, factorised, solved} = WorkbenchNumbers; // of symmetric matrices, `factorised` reads the lower half
  const REWEIGHTINGS = 3;
  const MOST_STEPS = 50;
  const CONVERGED = {exact: 1e-13, short: 1e-10}; // of the cost: what a further step would gain
  const DEPENDENT = {exact: 4e-10, short: 1e-7}; // of a column's square: what others must leave of it; see KEPT in reduce.py
  const TINY = 1e-300;

  function create(data, columns) {
    const {motors, reference, mapOf, combined} = columns;
    const n = data.motors.length;
    const own = data.own;
    const fitGains = data.fits_gains;
    const digits = data.basis ? "short" : "exact"; // numbers of 16 bits tell no finer
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
      return {index, K, grams: K === whole ? fitted : fitted.map((gram) => taken(gram, whole, index))};
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
        return torqueErrors(grams, K, at.d, at.gains).map((one) => 1 / Math.max(Math.sqrt(one / data.rows), 1e-9 * scale + TINY));
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
      const theta = new Float64Array(p);
      kept.forEach((column, i) => {
        d[column] = at.d[i];
        theta[column] = at.d[i] + system.start[column];
      });
      return {d, theta, gains: at.gains, kept};
    }

    /*
    What an effect's columns explain beside a solved system: Schur complements (b, b) and (b,); `whole` (b, b): the
    columns' own inner products.
    */
    function besides(system, solution, place) {
      const {index, K, grams} = keptOnly(system, solution.kept);
      const b = place.size;
      const all = index.map((at) => system.columns[at]);
      for (let i = 0; i < b; i++) all.push({index: [place.start + i], value: [1]});
      const size = all.length;
      const {gains} = solution;
      const d = solution.kept.map((at) => solution.d[at]);
      const now = left(grams, K, d, gains);
      const rms = now.map((one, j) => Math.sqrt(one.square / Math.max(data.motors[j].fitted.moving, 1)));
      const floor = 1e-12 * Math.max(...rms) + TINY;
      const weights = rms.map((one) => 1 / Math.max(one, floor));
      const {normal, right, size: unknowns, byGain} = linearisedStep(grams, K, d, gains, weights, now);
      const whole = new Float64Array(b * b);
      const score = new Float64Array(b);
      const cross = Array.from({length: b}, () => new Float64Array(unknowns));
      motors.forEach((motor, j) => {
        if (place.motor >= 0 && j !== place.motor) return; // its columns are zero there
        const gram = combined(motor, motor.fitted, all);
        const w = weights[j] ** 2;
        const g = gains[j];
        const error = now[j].x;
        for (let i = 0; i < b; i++) {
          const row = gram.subarray((K + i) * size, (K + i + 1) * size);
          for (let m = 0; m < b; m++) whole[i * b + m] += (w / (g * g)) * row[K + m];
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
      const inner = whole.slice();
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
      return {inner, score, whole};
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

    return {systemOf, errors, solve, besides, differenceOf, squares, dependent: DEPENDENT[digits]};
  }

  return {create};
})();
