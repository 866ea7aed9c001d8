import { describe, expect, it } from 'vitest';
import { byColour } from './painter';
import { boundsOf, cutting, distance, drawn, isUnstable, pick, project, roundLength } from './project';

/** From 0 along x, along y, then into an unknown place and back. */
const data = { ends: Float32Array.from([0, 0, 0, 10, 0, 0, 10, 10, 0, NaN, 0, 0, 0, 0, 4]), kinds: Uint8Array.from([0, 1, 2, 1, 0]) };
const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

describe('a path in space', () => {
  it('lies in its box', () => {
    const { low, high, centre, radius } = boundsOf(data);
    expect([low, high, centre]).toEqual([{ x: 0, y: 0, z: 0 }, { x: 10, y: 10, z: 4 }, { x: 5, y: 5, z: 2 }]);
    expect(radius).toBeCloseTo(Math.sqrt(216) / 2);
    expect(boundsOf({ ends: Float32Array.from([NaN, NaN, NaN]), kinds: Uint8Array.from([0]) }).radius).toBe(1);
  });
  it('has stretches between known places alone', () => {
    expect(drawn(data, cutting)).toEqual([1, 2]);
    expect(drawn(data, isUnstable)).toEqual([2]);
    expect(drawn(data, (kind) => kind === 0)).toEqual([]);
  });
});

describe('on the screen', () => {
  it('the middle is the middle, up is up', () => {
    const at = project(Float32Array.from([0, 0, 0, 1, 1, 0.5]), identity, 200, 100);
    expect([...at]).toEqual([100, 50, 0, 200, 0, 0.5]);
  });
  it('the nearest cutting block is found, of two the nearer to the eye, none from afar', () => {
    const places = Float32Array.from([0, 0, 0.5, 100, 0, 0.5, 100, 50, 0.5, 0, 50, 0.1, 0, 1, 0.1, 100, 1, 0.1]);
    expect(pick(places, [1, 2, 3, 4], 50, -3)).toBe(1);
    expect(pick(places, [1, 2, 3, 4], 97, 30)).toBe(2);
    expect(pick(places, [1, 2, 3, 4, 5], 50, 0.6)).toBe(5);
    expect(pick(places, [1, 2, 3], 50, 25)).toBeNull();
    expect(pick(places, [], 50, 0)).toBeNull();
  });
  it('a point beyond the end of a line is as far as that end', () => {
    expect(distance(4, 3, 0, 0, 0, 0)).toBe(5);
    expect(distance(13, 4, 0, 0, 10, 0)).toBe(5);
    expect(distance(5, 2, 0, 0, 10, 0)).toBe(2);
  });
  it('the axes have a round length', () => {
    expect([0.7, 1, 19, 20, 49.9, 5000].map(roundLength)).toEqual([0.5, 1, 10, 20, 20, 5000]);
  });
});

it('blocks of one colour are drawn at once', () => {
  const groups = byColour([1, 2, 3], Uint8Array.from([0, 0, 0, 1, 2, 3, 4, 5, 6, 1, 2, 3]));
  expect([...groups]).toEqual([['rgb(1, 2, 3)', [1, 3]], ['rgb(4, 5, 6)', [2]]]);
});
