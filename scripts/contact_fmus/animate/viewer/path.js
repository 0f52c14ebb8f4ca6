// Where bodies are between the rows of the result.

/** A vector over time, or one that stands still. */
class Path {
  constructor(times, positions, velocities) {
    this.times = times;
    this.positions = decodeNumbers(positions);
    this.velocities = velocities ? decodeNumbers(velocities) : null;
    this.still = this.positions.length === 3;
  }

  /**
   * With velocities by the cubic through both ends (Hermite): exact for free flight. Else by a straight line.
   * Row is that of the time, as rowBefore gives it.
   */
  at(t, row, out = [0, 0, 0]) {
    if (this.still) return [out[0], out[1], out[2]] = this.positions;
    const step = this.times[row + 1] - this.times[row];
    const share = shareOf(this.times, row, t);
    for (let k = 0; k < 3; k++) {
      const from = this.positions[3 * row + k];
      const way = this.positions[3 * row + 3 + k] - from;
      out[k] = from + share * way;
      if (this.velocities) {
        const begin = step * this.velocities[3 * row + k] - way;
        const end = way - step * this.velocities[3 * row + 3 + k];
        out[k] += share * (1 - share) * ((1 - share) * begin + share * end);
      }
    }
    return out;
  }
}

/** Unit quaternions w, x, y, z over time, joined by chords that are made unit again. */
class Turning {
  constructor(text) {
    this.values = decodeNumbers(text);
  }

  at(share, row) {
    const mixed = [0, 1, 2, 3].map((k) => this.values[4 * row + k] * (1 - share) + this.values[4 * row + 4 + k] * share);
    const size = Math.hypot(...mixed) || 1;
    return mixed.map((one) => one / size);
  }
}
