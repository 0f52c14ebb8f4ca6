// Which time of the run is shown when: playback time runs evenly, except that it dwells on contacts.

const REAL_TIME = [2, 30]; // s; a run that lasts so long is played in real time, others as if they did
const SHORT_RUN = 8; // s of playback for a run too short to be watched
const DWELL = 1.2; // s of playback for a contact that would be over sooner
const DWELLS = 24; // s, of all contacts together
const BESIDE = 0.5; // of a contact's duration is shown slowly before and after it

/** [time of the run, time of playback] pairs, both rising; straight lines between them. */
function playbackKnots(begin, end, touches, slow) {
  const span = end - begin;
  const playback = span < REAL_TIME[0] ? SHORT_RUN : Math.min(span, REAL_TIME[1]);
  const pace = playback / span;
  const knots = [[begin, 0]];
  const windows = slow ? slowWindows(begin, end, touches, pace) : [];
  const dwell = Math.min(DWELL, DWELLS / Math.max(1, windows.length)) * (1 + 2 * BESIDE);
  for (const [from, to] of windows) {
    const [time, shown] = knots[knots.length - 1];
    const start = shown + (from - time) * pace;
    if (from > time) knots.push([from, start]);
    knots.push([to, start + Math.max(dwell, (to - from) * pace)]);
  }
  const [time, shown] = knots[knots.length - 1];
  if (end > time) knots.push([end, shown + (end - time) * pace]);
  return knots;
}

/** Short contacts with what is beside them; those that overlap are one. A contact that lasts needs no dwelling. */
function slowWindows(begin, end, touches, pace) {
  const windows = [];
  for (const [from, to] of touches) {
    if (!(to > from) || (to - from) * pace > DWELL) continue;
    const air = BESIDE * (to - from);
    const [low, high] = [Math.max(begin, from - air), Math.min(end, to + air)];
    const last = windows[windows.length - 1];
    if (last && low <= last[1]) last[1] = Math.max(last[1], high);
    else windows.push([low, high]);
  }
  return windows.filter(([low, high]) => high > low);
}

class Playback {
  constructor(times, touches) {
    this.begin = times[0];
    this.end = times[times.length - 1];
    this.touches = touches;
    this.time = this.begin;
    this.speed = 1;
    this.playing = false;
    this.slow = true;
    this.rebuild();
  }

  rebuild() {
    this.knots = playbackKnots(this.begin, this.end, this.touches, this.slow);
    this.froms = this.knots.map((knot) => knot[0]);
    this.shown = this.knots.map((knot) => knot[1]);
    this.length = this.shown[this.shown.length - 1];
  }

  setSlow(slow) {
    this.slow = slow;
    this.rebuild();
  }

  /** Playback time of a time of the run, and the other way. */
  toShown(t) {
    return valueAt(this.froms, this.shown, t);
  }

  toTime(shown) {
    return valueAt(this.shown, this.froms, shown);
  }

  /** Seconds of the run for each second that is watched. */
  rate() {
    const row = Math.min(rowBefore(this.froms, this.time), this.froms.length - 2);
    return (this.speed * (this.froms[row + 1] - this.froms[row])) / (this.shown[row + 1] - this.shown[row]);
  }

  advance(seconds) {
    if (!this.playing) return;
    const shown = this.toShown(this.time) + seconds * this.speed;
    this.seek(this.toTime(Math.min(shown, this.length)));
    if (shown >= this.length) this.playing = false;
  }

  seek(t) {
    this.time = Math.min(this.end, Math.max(this.begin, t));
  }

  play() {
    if (this.time >= this.end) this.time = this.begin;
    this.playing = true;
  }
}
