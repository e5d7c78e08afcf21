"use strict";
/* The model with any effects in the shapes that were found: everything that enters linearly, and the gains, anew. */
const WorkbenchFit = (() => {
  const {floats, doubles, times} = WorkbenchNumbers;

  function placesOf(data) {
    return data.effects.flatMap((effect) =>
      effect.places.map((place) => ({
        ...place,
        effect: effect.name,
        key: place.place ? `${effect.name}:${place.place}` : effect.name,
      })),
    );
  }

  function create(data) {
    const {systemOf, solve, left, differenceOf, squares} = WorkbenchEquations.create(data);
    const {own} = data;
    const places = placesOf(data);
    const known = new Map();
    const reference = doubles(data.reference);
    const basis = {...data.basis, own: doubles(data.basis.own), others: floats(data.basis.others)};

    /* The model's own parameters, from how columns are combined beside the found model. */
    function parametersOf(difference) {
      const found = reference.map((value, i) => value + difference[i]);
      const parameters = times(basis.own, own, found);
      basis.columns.forEach((column, k) => {
        for (let i = 0; i < own; i++) parameters[i] += found[column] * basis.others[k * own + i];
      });
      return parameters;
    }

    /* The model with the effects of these keys, worked out once. Errors are shares of the measured current; `by` motor. */
    function fit(keys) {
      const name = JSON.stringify([...keys].sort());
      if (!known.has(name)) known.set(name, fitted(keys));
      return known.get(name);
    }

    function fitted(keys) {
      const terms = places.filter((place) => keys.has(place.key));
      const system = systemOf(terms);
      const solution = solve(system);
      const errors = {fitted: left("fitted", system, solution), judged: left("judged", system, solution)};
      const share = (use, j) => {
        const sum = (values) => (j === undefined ? values.reduce((a, b) => a + b, 0) : values[j]);
        return sum(squares[use]) > 0 ? Math.sqrt(sum(errors[use]) / sum(squares[use])) : null;
      };
      let at = own;
      const effects = terms.map((place) => {
        const values = place.parameters.map((parameter) => {
          const value = {...parameter, value: solution.d[at], absorbed: solution.absorbed(at)};
          at += 1;
          return value;
        });
        return {
          place,
          key: place.key,
          values: [...values, ...place.shape.map((parameter) => ({...parameter, shape: true}))],
        };
      });
      const difference = differenceOf(system, solution);
      return {
        fitted: share("fitted"),
        judged: share("judged"),
        by: data.motors.map((_, j) => ({
          fitted: share("fitted", j),
          judged: share("judged", j),
          gain: solution.gains[j],
        })),
        theta: parametersOf(difference),
        effects,
        difference,
        gains: solution.gains,
      };
    }

    return {fit, places};
  }

  return {create};
})();
