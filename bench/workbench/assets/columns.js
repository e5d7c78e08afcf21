"use strict";
/* The page's columns, motor by motor, and how an effect's are combined from them at any value and present model. */
const WorkbenchColumns = (() => {
  const {floats, doubles, triangleOf, gramOf} = WorkbenchNumbers;

  function motorOf(data, motor) {
    const size = motor.columns.length + 2;
    const index = new Int32Array(data.columns + 2).fill(-1);
    motor.columns.forEach((column, i) => (index[column] = i));
    index[data.columns] = size - 2;
    index[data.columns + 1] = size - 1;
    return {
      size,
      index,
      fitted: gramOf(triangleOf(motor.fitted.triangle, size), size),
      judged: gramOf(triangleOf(motor.judged.triangle, size), size),
    };
  }

  /* A stretch of an effect's scalar with the weights of its nodes for barycentric interpolation. */
  function pieceOf(piece) {
    const at = piece.logarithmic ? piece.nodes.map(Math.log) : piece.nodes;
    const unit = 4 / (at[at.length - 1] - at[0] || 1);
    const weights = at.map((x) => 1 / at.reduce((all, other) => (other === x ? all : all * (x - other) * unit), 1));
    return {...piece, at, weights, table: floats(piece.table)};
  }

  function placesOf(data) {
    const places = [];
    for (const effect of data.effects) {
      for (const place of effect.places) {
        const key = place.place ? `${effect.name}:${place.place}` : effect.name;
        const follows = place.follows && {...place.follows, coordinates: floats(place.follows.coordinates)};
        places.push({
          ...place,
          effect: effect.name,
          key,
          size: place.stop - place.start,
          count: place.parameters.length,
          parts: 1 + (follows ? follows.count : 0),
          follows,
          table: place.table && floats(place.table),
          pieces: place.pieces.map(pieceOf),
        });
      }
    }
    return places;
  }

  function create(data) {
    const own = data.own;
    const reference = doubles(data.reference);
    const foundGains = data.motors.map((motor) => motor.gain);
    const motors = data.motors.map((motor) => motorOf(data, motor));
    const places = placesOf(data);
    const found = {gains: foundGains, difference: null}; // the model about which the page's columns are taken

    /* Which piece of an effect's scalar a value belongs to, and whether it lies beyond all. */
    function within(place, value, branch = 0) {
      const gap = (piece) => Math.max(piece.nodes[0] - value, value - piece.nodes[piece.nodes.length - 1], 0);
      const own = place.pieces.filter((piece) => piece.branch === branch);
      let best = own[0];
      for (const piece of own) if (gap(piece) < gap(best)) best = piece;
      return {piece: best, outside: best.nodes.length > 1 && gap(best) > 1e-9 * Math.abs(value)};
    }

    /* Coefficients of an effect's columns, part after part of the present model: a polynomial through the nodes. */
    function tableOf({place, value, branch}) {
      const total = place.parts * place.count * place.size;
      if (!place.pieces.length) return place.table;
      const {piece} = within(place, value, branch);
      const last = piece.nodes.length - 1;
      const inside = Math.min(Math.max(value, piece.nodes[0]), piece.nodes[last]);
      const x = piece.logarithmic ? Math.log(inside) : inside;
      const close = 1e-14 * Math.max(Math.abs(piece.at[0]), Math.abs(piece.at[last]));
      const exact = last === 0 ? 0 : piece.at.findIndex((at) => Math.abs(at - x) <= close);
      if (exact >= 0) return piece.table.subarray(exact * total, (exact + 1) * total);
      const table = new Float64Array(total);
      let sum = 0;
      piece.at.forEach((at, node) => {
        const share = piece.weights[node] / (x - at);
        sum += share;
        for (let i = 0; i < total; i++) table[i] += share * piece.table[node * total + i];
      });
      for (let i = 0; i < total; i++) table[i] /= sum;
      return table;
    }

    /* Coefficients (k, b) of an effect's columns beside a present model. */
    function coefficients(term, present) {
      const {place} = term;
      const {gains, difference} = present;
      let scale = 1;
      if (place.scale !== "none") scale = place.scale === "gain" ? gains[place.motor] : Math.abs(gains[place.motor]);
      const total = place.count * place.size;
      const result = new Float64Array(total);
      if (place.kind === "linear" && !place.follows) {
        for (let k = 0; k < place.count; k++) result[k * place.size + k] = scale;
        return result;
      }
      const table = tableOf(term);
      for (let i = 0; i < total; i++) result[i] = scale * table[i];
      if (!place.follows || !difference) return result;
      const {count, columns, coordinates} = place.follows;
      for (let part = 0; part < count; part++) {
        let share = 0;
        columns.forEach((column, i) => (share += coordinates[part * columns.length + i] * difference[column]));
        for (let i = 0; i < total; i++) result[i] += scale * share * table[(part + 1) * total + i];
      }
      return result;
    }

    /* What the columns of a model are made of: for each the page's columns and how much of them. */
    function mapOf(terms, present) {
      const columns = [];
      for (let i = 0; i < own; i++) columns.push({index: [i], value: [1]});
      const known = new Map();
      for (let i = own; i < reference.length; i++) if (reference[i] !== 0) known.set(i, -reference[i]);
      for (const term of terms) {
        const table = coefficients(term, present);
        const {start, size, count} = term.place;
        const index = Array.from({length: size}, (_, i) => start + i);
        for (let k = 0; k < count; k++) {
          const value = Array.from(table.subarray(k * size, (k + 1) * size));
          if (term.fixed) index.forEach((at, i) => known.set(at, (known.get(at) || 0) + term.value * value[i]));
          else columns.push({index, value});
        }
      }
      const p = columns.length;
      columns.push({index: [...known.keys()], value: [...known.values()]});
      columns.push({index: [reference.length], value: [1]}, {index: [reference.length + 1], value: [1]});
      return {columns, p};
    }

    /* Inner products of combined columns, (K, K). Most columns are the page's own as they are. */
    function combined(motor, gram, columns) {
      const K = columns.length;
      const {size} = motor;
      const plain = new Int32Array(K).fill(-1);
      const pairs = columns.map(({index, value}, k) => {
        if (index.length === 1 && value[0] === 1) {
          plain[k] = motor.index[index[0]];
          return null;
        }
        const found = [];
        index.forEach((at, i) => motor.index[at] >= 0 && value[i] !== 0 && found.push([motor.index[at], value[i]]));
        return found;
      });
      const found = new Float64Array(K * K);
      const mixed = new Float64Array(size);
      for (let a = 0; a < K; a++) {
        let row = mixed;
        if (pairs[a]) {
          mixed.fill(0);
          for (const [i, x] of pairs[a]) for (let b = 0; b < size; b++) mixed[b] += x * gram[i * size + b];
        } else if (plain[a] < 0) continue;
        else row = gram.subarray(plain[a] * size, (plain[a] + 1) * size);
        for (let b = 0; b < K; b++) {
          if (pairs[b] && b < a) continue;
          let sum = 0;
          if (pairs[b]) for (const [i, x] of pairs[b]) sum += x * row[i];
          else if (plain[b] >= 0) sum = row[plain[b]];
          found[a * K + b] = found[b * K + a] = sum;
        }
      }
      return found;
    }

    return {motors, places, reference, found, within, coefficients, mapOf, combined};
  }

  return {create};
})();
