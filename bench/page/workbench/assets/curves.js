"use strict";
/* Measured, modelled and error of one motor in one recording, at the rows that the page carries. */
const WorkbenchCurves = (() => {
  const {floats, counts} = WorkbenchNumbers;

  function create(data) {
    const decoded = new Map();

    function sampleOf(recording, motor) {
      const key = `${recording} ${motor}`;
      if (!decoded.has(key)) {
        const packed = data.recordings[recording].motors[motor];
        decoded.set(key, {
          columns: packed.columns,
          counts: counts(packed.counts),
          steps: floats(packed.steps),
          modelled: floats(packed.modelled),
          measured: floats(packed.measured),
          low: [...floats(packed.low)],
          high: [...floats(packed.high)],
          time: [...floats(data.recordings[recording].time)],
        });
      }
      return decoded.get(key);
    }

    /* Curves of a fit; null where the joint stands still, which is neither fitted nor judged. */
    function of(fit, recording, motor) {
      const sample = sampleOf(recording, motor);
      const rows = sample.measured.length;
      const torque = new Float64Array(rows);
      sample.columns.forEach((column, c) => {
        const share = fit.difference[column] * sample.steps[c];
        if (share !== 0) for (let i = 0; i < rows; i++) torque[i] += share * sample.counts[c * rows + i];
      });
      const [gain, before] = [fit.gains[motor], data.motors[motor].gain];
      const modelled = [];
      const error = [];
      for (let i = 0; i < rows; i++) {
        const value = (before * sample.modelled[i] + torque[i]) / gain;
        const known = Number.isFinite(value);
        modelled.push(known ? value : null);
        error.push(known ? sample.measured[i] - value : null);
      }
      return {time: sample.time, low: sample.low, high: sample.high, modelled, error};
    }

    return {of};
  }

  return {create};
})();
