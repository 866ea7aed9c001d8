// How long a redraw took from the movement of the hand.
const most = 200;

declare global {
  interface Window {
    robomillLatency?: number[]; // ms, the last ones
  }
}

/** `started` is an event's timeStamp. */
export function recordLatency(started: number): void {
  const name = 'robomill: movement to redraw';
  const { duration } = performance.measure(name, { start: started, end: performance.now() });
  performance.clearMeasures(name);
  const all = (window.robomillLatency ??= []);
  all.push(duration);
  if (all.length > most) all.splice(0, all.length - most);
}
