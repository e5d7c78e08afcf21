"use strict";
/*
The model with any effects: shapes found, columns linearised about the present model, as bench/identification/nonlinear.py and
newton.py do.
*/
const WorkbenchFit = (() => {
  const {floats, doubles, product, times, factorised, solved, smallest} = WorkbenchNumbers;
  const MOST_ROUNDS = 6;
  const SETTLED = 1e-4;
  const AS_GOOD = 1e-6; // relative change of the RMS errors between rounds: far less than chance makes of them
  const NO_WORSE = 1e-9; // relative: squared errors that are the same but for rounding
  const STRIDE = 0.5; // of a shape's value: the most that it may change at once with all others
  const SHAPE_STEP = 1e-3; // likewise, for the derivative by it
  const NEARBY = 0.02; // of a shape's present value: how far around it the shape is searched, beside all else

  function create(data) {
    const columns = WorkbenchColumns.create(data);
    const {motors, places, reference, found, within, coefficients, combined} = columns;
    const {systemOf, errors, solve, besides, differenceOf, squares, dependent} = WorkbenchEquations.create(data, columns);
    const own = data.own;
    const basis = data.basis && {...data.basis, own: doubles(data.basis.own), others: floats(data.basis.others)};

    /* The model's own parameters, from how columns are combined beside the found model. */
    function parametersOf(difference) {
      const found = reference.subarray(0, own).map((value, i) => value + difference[i]);
      if (!basis) return found;
      const parameters = times(basis.own, own, found);
      basis.columns.forEach((column, k) => {
        const share = reference[column] + difference[column];
        for (let i = 0; i < own; i++) parameters[i] += share * basis.others[k * own + i];
      });
      return parameters;
    }

    /* The neighbourhood of a shape's present value, which competes with the others. */
    function nearby({place, value}, brackets, branch) {
      if (value <= 0 || !brackets.some(([low, , high]) => low < high)) return [];
      const {piece, outside} = within(place, value, branch);
      if (outside || piece.nodes.length < 2) return [];
      const last = piece.nodes[piece.nodes.length - 1];
      return [[Math.max(value * (1 - NEARBY), piece.nodes[0]), value, Math.min(value * (1 + NEARBY), last)]];
    }

    /* The branch and the value of a shape that explain most of what is left; held: the value stays. */
    function bestShape(term, {inner, score, whole}, present) {
      const {place} = term;
      const {count, size} = place;
      const unexplained = (value, branch) => {
        const table = coefficients({place, value, branch}, present);
        const matrix = new Float64Array(count * count);
        const right = new Float64Array(count);
        const squares = new Float64Array(count);
        for (let a = 0; a < count; a++) {
          const column = table.subarray(a * size, (a + 1) * size);
          const row = times(inner, size, column);
          squares[a] = product(whole, size, column, column);
          for (let i = 0; i < size; i++) right[a] += table[a * size + i] * score[i];
          for (let b = 0; b < count; b++) {
            for (let i = 0; i < size; i++) matrix[b * count + a] += table[b * size + i] * row[i];
          }
        }
        // what rounding leaves of a column that others take up would explain something by chance
        const x = solved(factorised(matrix, count, dependent, squares), right);
        return -right.reduce((sum, one, i) => sum + one * x[i], 0);
      };
      const along = (brackets, branch) => {
        if (term.held) return {value: term.value, branch, cost: unexplained(term.value, branch)};
        let best = null;
        for (const [low, value, high] of [...brackets, ...nearby(term, brackets, branch)]) {
          const cost = unexplained(value, branch);
          if (!best || cost < best.cost) best = {low, value, high, cost, branch};
        }
        if (best.low === best.high) return best;
        const tolerance = 1e-4 * Math.max(Math.abs(best.low), Math.abs(best.high));
        const reached = smallest((value) => unexplained(value, branch), best.low, best.high, tolerance);
        return reached.cost < best.cost ? {value: reached.at, cost: reached.cost, branch} : best;
      };
      return place.brackets.map(along).reduce((best, one) => (one.cost < best.cost ? one : best));
    }

    function about(terms, theta) {
      let at = own;
      for (const term of terms) {
        if (term.fixed) continue;
        if (term.place.kind === "value") term.value = theta[at];
        at += term.place.count;
      }
    }

    function solveWith(terms, present) {
      const system = systemOf(terms, present);
      const solution = solve(system);
      return {system, solution, present: {gains: solution.gains, difference: differenceOf(system, solution)}};
    }

    const moves = ({place, held, branch}) =>
      place.kind === "shape" && !held && place.brackets[branch].some(([low, , high]) => low < high);

    /* The torque's derivative by a term's shape, as a combination of the page's columns; theta: of its effect. */
    function derivative(term, theta, present) {
      const {count, size, start} = term.place;
      const step = SHAPE_STEP * (Math.abs(term.value) || 1);
      const [before, after] = [-step, step].map((by) => coefficients({...term, value: term.value + by}, present));
      const value = new Array(size).fill(0);
      for (let k = 0; k < count; k++) {
        for (let i = 0; i < size; i++) value[i] += (theta[k] * (after[k * size + i] - before[k * size + i])) / (2 * step);
      }
      return {index: Array.from({length: size}, (_, i) => start + i), value};
    }

    const spread = ({system, solution}) => errors(system.fitted, system.K, solution.d, solution.gains);

    /* All shapes moved at once by a step of Gauss and Newton, with all linear unknowns, and solved; null if that is worse. */
    function stepped(terms, present) {
      if (!terms.some(moves)) return null;
      const now = solveWith(terms, present);
      const {system, solution} = now;
      const added = [];
      let at = own;
      for (const term of terms) {
        if (term.fixed) continue;
        const theta = solution.theta.subarray(at, at + term.place.count);
        if (moves(term)) added.push(derivative(term, theta, present));
        at += term.place.count;
      }
      const p = system.p + added.length;
      const columns = [...system.columns.slice(0, system.p), ...added, ...system.columns.slice(system.p)];
      const start = new Float64Array(p);
      start.set(system.start);
      const fitted = motors.map((one) => combined(one, one.fitted, columns));
      const steps = solve({columns, p, K: p + 3, start, fitted}).d.subarray(system.p);
      let next = 0;
      const moved = terms.map((term) => {
        if (!moves(term)) return term;
        const most = STRIDE * Math.abs(term.value);
        const value = term.value + Math.min(Math.max(steps[next++], -most), most);
        const {nodes} = within(term.place, value, term.branch).piece;
        return {...term, value: Math.min(Math.max(value, nodes[0]), nodes[nodes.length - 1])};
      });
      const reached = solveWith(moved, present);
      const before = spread(now);
      const ratio = spread(reached).reduce((sum, one, j) => sum + one / before[j], 0) / before.length;
      if (!(ratio <= 1 + NO_WORSE)) return null;
      terms.forEach((term, i) => (term.value = moved[i].value));
      return reached;
    }

    const alike = (now, before, share) => now.every((value, i) => Math.abs(value - before[i]) <= share * Math.abs(value));

    /*
    Shapes found and columns linearised, in a few rounds, as bench/identification/nonlinear.py does it: the present model. It
    pauses after every part of the work, so that the page can stay awake.
    */
    function* settled(terms) {
      if (!terms.some((term) => term.place.curved)) return found;
      let {present} = solveWith(terms.filter((term) => !term.place.curved), found);
      let before = null;
      for (let round = 0; round < MOST_ROUNDS; round++) {
        let reached = before && stepped(terms, present);
        if (!reached) {
          for (const term of terms) {
            if (term.place.kind !== "shape" || (term.held && term.place.brackets.length < 2)) continue;
            const others = solveWith(terms.filter((other) => other !== term), present);
            Object.assign(term, chosen(bestShape(term, besides(others.system, others.solution, term.place), present)));
            yield;
          }
          reached = solveWith(terms, present);
        }
        present = reached.present;
        yield;
        about(terms, reached.solution.theta);
        const curves = terms.filter((term) => term.place.kind === "shape").map((term) => term.value);
        const now = {gains: present.gains, curves, errors: spread(reached).map(Math.sqrt)};
        if (before && alike(now.gains, before.gains, SETTLED)) {
          if (alike(curves, before.curves, SETTLED) || alike(now.errors, before.errors, AS_GOOD)) break;
        }
        before = now;
      }
      return present;
    }

    const chosen = ({value, branch}) => ({value, branch});

    /* Effects that are ticked, held at a value or about to be searched. */
    const termsOf = (keys, held) =>
      places
        .filter((place) => keys.has(place.key))
        .map((place) => ({
          place,
          value: held[place.key] ?? (place.kind === "shape" ? place.shape.value : 0),
          branch: 0,
          held: held[place.key] !== undefined,
          fixed: held[place.key] !== undefined && place.kind === "value",
        }));

    /*
    The model with the effects of these keys. held: values by key at which a shape, or a time, is held. Errors are
    shares of the measured current; `by` motor. In parts: what the last one returns is the model.
    */
    function* fitted(keys, held = {}) {
      const terms = termsOf(keys, held);
      const present = yield* settled(terms);
      const system = systemOf(terms, present);
      return answered(terms, present, system, solve(system));
    }

    /*
    Nearly the same in an instant, from a model nearby: what that one has stays in its shape, and shapes that are new
    are looked for beside it; columns that follow the model are linearised about it once.
    */
    function nearly(keys, held, near) {
      const {terms: before, system: at, solution: from} = near.made;
      let {present} = near.made;
      const terms = termsOf(keys, held);
      for (const term of terms) {
        const known = before.find((other) => other.place === term.place);
        if (term.held) continue;
        if (known) Object.assign(term, {value: known.value, branch: known.branch});
        else if (term.place.kind === "shape") {
          Object.assign(term, chosen(bestShape(term, besides(at, from, term.place), present)));
        }
      }
      if (terms.some((term) => term.place.follows || term.place.kind === "value")) {
        const reached = solveWith(terms, present);
        present = reached.present;
        about(terms, reached.solution.theta);
      }
      const system = systemOf(terms, present);
      return answered(terms, present, system, solve(system));
    }

    function answered(terms, present, system, solution) {
      const left = {fitted: errors(system.fitted, system.K, solution.d, solution.gains)};
      const judged = motors.map((one) => combined(one, one.judged, system.columns));
      left.judged = errors(judged, system.K, solution.d, solution.gains);
      const share = (use, j) => {
        const sum = (values) => (j === undefined ? values.reduce((a, b) => a + b, 0) : values[j]);
        return sum(squares[use]) > 0 ? Math.sqrt(sum(left[use]) / sum(squares[use])) : null;
      };
      let at = own;
      const effects = terms.map((term) => {
        const values = [];
        let shown = false;
        for (const parameter of term.place.parameters) {
          if (term.fixed) values.push({...parameter, value: term.value, held: true});
          else values.push({...parameter, value: solution.theta[at], absorbed: !solution.kept.includes(at)});
          if (!term.fixed) at += 1;
          shown = shown || values[values.length - 1].value !== 0;
        }
        if (term.place.kind === "shape") {
          const {others, branches, ...moved} = term.place.shape;
          others.forEach((one, i) => values.push({...one, value: branches[term.branch][i]}));
          values.push({...moved, value: term.value, held: term.held, searched: true});
        }
        const outside = term.place.kind === "value" && !term.fixed && within(term.place, term.value).outside;
        return {place: term.place, key: term.place.key, values, outside, shown};
      });
      const difference = differenceOf(system, solution);
      return {
        fitted: share("fitted"),
        judged: share("judged"),
        by: data.motors.map((motor, j) => ({fitted: share("fitted", j), judged: share("judged", j), gain: solution.gains[j]})),
        theta: parametersOf(difference),
        effects,
        difference,
        gains: solution.gains,
        made: {terms, present, system, solution},
      };
    }

    /* The same at once. */
    function fit(keys, held) {
      const work = fitted(keys, held);
      let part = work.next();
      while (!part.done) part = work.next();
      return part.value;
    }

    return {fit, fitted, nearly, places};
  }

  return {create};
})();
