"use strict";
/* Numbers in text, and small dense matrices (row after row in a Float64Array). */
const WorkbenchNumbers = (() => {
  function bytes(text) {
    const raw = atob(text);
    const found = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) found[i] = raw.charCodeAt(i);
    return new DataView(found.buffer);
  }

  function read(text, size, at) {
    const view = bytes(text);
    const count = view.byteLength / size;
    const values = new Float64Array(count);
    for (let i = 0; i < count; i++) values[i] = at(view, i * size);
    return values;
  }

  const floats = (text) => read(text, 4, (view, i) => view.getFloat32(i, true));
  const doubles = (text) => read(text, 8, (view, i) => view.getFloat64(i, true));
  const counts = (text) => read(text, 2, (view, i) => view.getInt16(i, true));

  /* Inner products (c, c) of the columns whose triangular factor is packed row after row; of no rows, it is empty. */
  function gramOf(packed, size) {
    const gram = new Float64Array(size * size);
    let at = 0;
    for (let row = 0; row < size; row++) {
      for (let a = row; a < size; a++) {
        const left = packed[at + a - row];
        if (left) for (let b = a; b < size; b++) gram[a * size + b] += left * packed[at + b - row];
      }
      at += size - row;
    }
    for (let a = 0; a < size; a++) for (let b = 0; b < a; b++) gram[a * size + b] = gram[b * size + a];
    return gram;
  }

  /* The sum of products of two rows, four at a time: the page spends most of its time here. */
  function dot(left, i, right, k, count) {
    let a = 0;
    let b = 0;
    let c = 0;
    let d = 0;
    let m = 0;
    const whole = count - (count % 4);
    for (; m < whole; m += 4) {
      a += left[i + m] * right[k + m];
      b += left[i + m + 1] * right[k + m + 1];
      c += left[i + m + 2] * right[k + m + 2];
      d += left[i + m + 3] * right[k + m + 3];
    }
    for (; m < count; m++) a += left[i + m] * right[k + m];
    return a + b + (c + d);
  }

  /* x' G y for vectors (size,). */
  function product(gram, size, x, y) {
    let sum = 0;
    for (let a = 0; a < size; a++) if (x[a] !== 0) sum += x[a] * dot(gram, a * size, y, 0, size);
    return sum;
  }

  function times(gram, size, x) {
    const found = new Float64Array(size);
    for (let a = 0; a < size; a++) found[a] = dot(gram, a * size, x, 0, size);
    return found;
  }

  /*
  Cholesky factor of a symmetric matrix whose diagonal is made one first. A column that the ones before leave less than
  `least` of, in squares, is passed over: its unknown is zero.
  */
  function factorised(matrix, size, least = 1e-14) {
    const norms = new Float64Array(size);
    for (let i = 0; i < size; i++) norms[i] = Math.sqrt(Math.max(matrix[i * size + i], 0)) || 1;
    const factor = new Float64Array(size * size);
    const passed = new Uint8Array(size);
    for (let i = 0; i < size; i++) {
      for (let k = 0; k <= i; k++) {
        const value = matrix[i * size + k] / (norms[i] * norms[k]) - dot(factor, i * size, factor, k * size, k);
        if (k < i) factor[i * size + k] = passed[k] ? 0 : value / factor[k * size + k];
        else if (value > least) factor[i * size + i] = Math.sqrt(value);
        else passed[i] = 1;
      }
      if (passed[i]) factor.fill(0, i * size, (i + 1) * size);
    }
    return {factor, norms, passed, size};
  }

  /* x with (matrix) x = right, from its factor. */
  function solved({factor, norms, passed, size}, right) {
    const x = new Float64Array(size);
    for (let i = 0; i < size; i++) {
      if (passed[i]) continue;
      x[i] = (right[i] / norms[i] - dot(factor, i * size, x, 0, i)) / factor[i * size + i];
    }
    for (let i = size - 1; i >= 0; i--) {
      if (passed[i]) continue;
      x[i] /= factor[i * size + i];
      for (let k = 0; k < i; k++) x[k] -= factor[i * size + k] * x[i];
    }
    for (let i = 0; i < size; i++) x[i] /= norms[i];
    return x;
  }

  return {floats, doubles, counts, gramOf, product, times, factorised, solved};
})();
