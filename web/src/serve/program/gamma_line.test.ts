import { describe, expect, it } from 'vitest';
import type { GammaMap } from '../../documents';
import { boundsOf, changed, chosenMargins, gammaAt, lineAlong, lineMargin, marginsAlong, most_knots, placeOfBlock, rested, sameLine, shifted, undone, widestGap, withGamma, withKnot, withoutKnot, withPath, type GammaLine, type LineHistory } from './gamma_line';

const map: GammaMap = {
  block: [3, 5, 9, 12],
  path_mm: [10, 20, 40, 50],
  gamma_deg: [-30, 0, 30],
  margin: [
    [-0.6, 0, null, 0.1],
    [0.2, 0.3, 0.1, 0.4],
    [0.4, -0.1, 0.5, 0.6],
  ],
  chosen_deg: [0, 10, 30, 30],
  programmed_deg: [0, 0, 0, 0],
  least_margin: 0.2,
};
const bounds = boundsOf(map);
const line: GammaLine = [[10, 0], [30, 20], [50, -10]];

describe('a line of γ', () => {
  it('is straight between its knots and constant beyond', () => {
    expect([0, 10, 20, 30, 40, 50, 90].map((path) => gammaAt(line, path))).toEqual([0, 0, 10, 20, 5, -10, -10]);
    expect(gammaAt([[30, 7]], 2)).toBe(7);
    expect(gammaAt([[30, 7]], 60)).toBe(7);
  });
  it('stays in the map', () => {
    expect(bounds).toEqual({ path: [10, 50], gamma: [-30, 30] });
    expect(withGamma(line, 1, 99, bounds)[1]).toEqual([30, 30]);
    expect(withGamma(line, 0, -99, bounds)[0]).toEqual([10, -30]);
    expect(line[1]).toEqual([30, 20]);
  });
  it('keeps its knots in order', () => {
    expect(withPath(line, 1, 5, bounds)[1]![0]).toBeCloseTo(10.01);
    expect(withPath(line, 1, 80, bounds)[1]![0]).toBeCloseTo(49.99);
    expect(withPath(line, 2, 80, bounds)[2]).toEqual([50, -10]);
    expect(withPath(line, 0, -5, bounds)[0]).toEqual([10, 0]);
    const close: GammaLine = [[10, 0], [10.01, 1], [10.02, 2]];
    for (const [path] of withPath(close, 1, 30, bounds)) expect(path).toBeLessThanOrEqual(10.02);
  });
  it('is moved as a whole, and keeps its shape at the ends of the map', () => {
    expect(shifted(line, 5, bounds)).toEqual([[10, 5], [30, 25], [50, -5]]);
    expect(shifted(line, 500, bounds)).toEqual([[10, 10], [30, 30], [50, 0]]);
    expect(shifted(line, -500, bounds)).toEqual([[10, -20], [30, 0], [50, -30]]);
  });
  it('gets a knot that does not bend it, once at a place', () => {
    const more = withKnot(line, 20, bounds);
    expect(more).toEqual([[10, 0], [20, 10], [30, 20], [50, -10]]);
    for (let path = 0; path <= 60; path += 3) expect(gammaAt(more, path)).toBeCloseTo(gammaAt(line, path));
    expect(withKnot(more, 20, bounds)).toBe(more);
    expect(withKnot(line, 500, bounds)).toBe(line);
    const full: GammaLine = Array.from({ length: most_knots }, (_, i) => [10 + i / 20, 0]);
    expect(withKnot(full, 49.99, bounds)).toBe(full);
  });
  it('loses knots but the last', () => {
    expect(withoutKnot(line, 1)).toEqual([[10, 0], [50, -10]]);
    expect(withoutKnot([[10, 0]], 0)).toEqual([[10, 0]]);
  });
  it('has a widest gap', () => {
    expect(widestGap([[10, 0], [25, 0], [50, 0]], bounds)).toBe(37.5);
    expect(widestGap([[40, 0]], bounds)).toBe(25);
  });
});

describe('a line along the γ of a map', () => {
  it('has a knot where it bends, and no other', () => {
    expect(lineAlong(map, map.programmed_deg)).toEqual([[10, 0], [50, 0]]);
    expect(lineAlong(map, [0, 10, 30, 30])).toEqual([[10, 0], [40, 30], [50, 30]]);
    expect(lineAlong(map, [0, 0, 30, 30])).toEqual([[10, 0], [20, 0], [40, 30], [50, 30]]);
  });
  it('goes over what is not known', () => {
    expect(lineAlong(map, [null, 5, null, 5])).toEqual([[20, 5], [50, 5]]);
    expect(lineAlong(map, [null, null, 4, null])).toEqual([[40, 4]]);
    expect(lineAlong(map, [null, null, null, null])).toEqual([[10, 0]]);
  });
  it('follows it closely with the knots that it may have', () => {
    const path_mm = Array.from({ length: 200 }, (_, i) => i);
    const gamma = path_mm.map((at) => 25 * Math.sin(at / 30));
    const wavy = { ...map, path_mm };
    const furthest = (along: GammaLine) => Math.max(...path_mm.map((at, i) => Math.abs(gamma[i]! - gammaAt(along, at))));
    const along = lineAlong(wavy, gamma);
    expect(along.length).toBeLessThanOrEqual(24);
    expect(furthest(along)).toBeLessThan(1);
    expect(furthest(lineAlong(wavy, gamma, 200))).toBeLessThanOrEqual(0.05);
  });
  it('has increasing knots where places of the map coincide', () => {
    const along = lineAlong({ ...map, path_mm: [10, 10, 10, 50] }, [0, 20, 5, 5]);
    along.slice(1).forEach(([path], i) => expect(path).toBeGreaterThan(along[i]![0]));
  });
});

describe('margins along a line', () => {
  it('are read off the map', () => {
    expect(marginsAlong(map, [[10, 0], [50, 0]])).toEqual(map.margin[1]);
    expect(marginsAlong(map, [[10, 15]])[0]).toBeCloseTo(0.3);
    expect(marginsAlong(map, [[10, -30]])).toEqual([-0.6, 0, null, 0.1]);
    expect(marginsAlong(map, [[10, -15]])[2]).toBeNull();
  });
  it('is known along γ as chosen', () => {
    const [first, , ...others] = chosenMargins({ ...map, chosen_deg: [0, 0, 30, -30] });
    expect([first, ...others]).toEqual([0.2, 0.5, 0.1]);
  });
  it('have a least one, somewhere', () => {
    expect(lineMargin([0.3, -0.1, null, -0.4])).toEqual({ least: -0.4, index: 3, unstable: 2, without: 1 });
    expect(lineMargin([null, null])).toEqual({ least: null, index: null, unstable: 0, without: 2 });
  });
});

it('places blocks that the map does not have between those that it has', () => {
  expect([1, 3, 4, 7, 12, 40].map((block) => placeOfBlock(map, block))).toEqual([10, 10, 15, 30, 50, 50]);
});

describe('steps back', () => {
  const begin: LineHistory = { line, past: [], gesture: null };
  const moved = (gamma: number) => withGamma(line, 0, gamma, bounds);
  it('take a whole gesture', () => {
    const dragged = [1, 2, 3].reduce((history, gamma) => changed(history, moved(gamma), 'drag 1'), begin);
    expect(dragged.past).toEqual([line]);
    const again = changed(rested(dragged), moved(9), 'drag 1');
    expect(again.past).toHaveLength(2);
    expect(undone(again).line).toEqual(moved(3));
    expect(undone(undone(again)).line).toEqual(line);
    expect(undone(undone(undone(again))).line).toEqual(line);
  });
  it('are none where nothing changed', () => {
    expect(changed(begin, line.map(([path, gamma]) => [path, gamma]), 'key')).toBe(begin);
    expect(sameLine(line, line.slice(1))).toBe(false);
  });
});
