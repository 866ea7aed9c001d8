import { describe, expect, it } from 'vitest';
import { blocksSample } from './blocks_sample';
import { dark, light } from './figures/theme';
import { blockFacts, boundOf, colourAt, coloursOf, gradient, limitOf, pathData, programFacts, quantitiesOf, rangeOf, thinned, worstBlocks } from './path_views';

const { blocks: columns } = blocksSample;
const values = (index: number) => Object.fromEntries(blockFacts(columns, index).map(({ label, value }) => [label, value]));

describe('a path', () => {
  it('has kinds and places', () => {
    const { ends, kinds } = pathData(columns);
    expect([...kinds]).toEqual([0, 1, 2, 1]);
    expect([...ends.slice(3, 6)]).toEqual([10, 0, -1]);
  });
  it('is coloured by what some block has', () => {
    expect(quantitiesOf(columns).map(({ key }) => key)).toEqual(['stability_margin', 'limit_depth_mm', 'regime', 'peak_f_n', 'surface_error_um', 'surface_left_um']);
    expect(quantitiesOf({ ...columns, peak_f_n: [null, null, null, null] }).map(({ key }) => key)).not.toContain('peak_f_n');
  });
  it('shows the worst in the colour that stands out, whichever end that is', () => {
    for (const theme of [light, dark]) {
      const loud = colourAt(theme.scale, 1);
      const [margin, , , force] = quantitiesOf(columns);
      expect([...coloursOf(columns, margin!, theme).blocks.slice(6, 9)]).toEqual(loud);
      expect([...coloursOf(columns, force!, theme).blocks.slice(6, 9)]).toEqual(loud);
      const bar = gradient(theme, 'low');
      expect(bar.indexOf(theme.scale[theme.scale.length - 1]![1])).toBeLessThan(bar.indexOf(theme.scale[0]![1]));
    }
    const grey = coloursOf(columns, quantitiesOf(columns)[1]!, light).blocks.slice(9, 12);
    expect([...grey]).toEqual([0x8a, 0x94, 0xa3]); // no limit found
  });
  it('gives each regime its own colour', () => {
    const { blocks } = coloursOf(columns, quantitiesOf(columns)[2]!, light);
    expect(new Set([1, 2, 3].map((i) => blocks.slice(3 * i, 3 * i + 3).join())).size).toBe(3);
  });
});

describe('a colour', () => {
  it('is exact at the stops of a scale and between them', () => {
    const scale: [number, string][] = [[0, '#000000'], [0.5, '#64c800'], [1, '#ffffff']];
    expect(colourAt(scale, 0)).toEqual([0, 0, 0]);
    expect(colourAt(scale, 0.25)).toEqual([50, 100, 0]);
    expect(colourAt(scale, 0.5)).toEqual([100, 200, 0]);
    expect(colourAt(scale, 7)).toEqual([255, 255, 255]);
  });
  it('is not wasted on a few values far away', () => {
    const many = Array.from({ length: 200 }, (_, i) => i / 200);
    expect(rangeOf([...many, 1000])).toEqual({ low: 0, high: expect.closeTo(0.98, 1), below: false, above: true });
    expect(rangeOf(many)).toMatchObject({ low: 0, high: 0.995, above: false });
    expect(rangeOf([null, 3, null])).toMatchObject({ low: 3, high: 3 });
    expect(rangeOf([null])).toMatchObject({ low: 0, high: 1 });
  });
});

describe('a block', () => {
  it('says what is known of it', () => {
    expect(values(0)).toMatchObject({ Block: '1', Line: '10', Cut: 'none' });
    expect(values(2)).toMatchObject({ Verdict: 'unstable', Regime: 'mode coupling', Note: '<b>far</b>', Dynamics: 'far from every measured posture' });
    expect(values(2)['Limit (5\u00a0–\u00a095\u00a0%)']).toMatch(/^0\.7 \(0\.6.*0\.8\).*a lower bound$/);
    expect(values(1)['Torque']).toBeUndefined();
  });
  it('says the error that its pass leaves, and what of it remains on the finished surface', () => {
    expect(values(1)).toMatchObject({ 'Surface error': '12\u202fµm', 'Error of the finished surface': '9\u202fµm' });
    expect(values(3)['Error of the finished surface']).toBeUndefined();
  });
  it('without a limit says so', () => {
    expect(limitOf(columns, 3)).toMatch(/^none found \(1\.9.*none\)$/);
    expect(values(3)['Regime']).toBe('no limit found');
  });
});

it('names the blocks nearest to chatter first', () => {
  expect(worstBlocks(columns, 2)).toEqual([2, 1]);
  const facts = programFacts(blocksSample);
  expect(facts).toContainEqual({ label: 'Nearest to chatter', value: 'block 3, margin -0.7' });
  expect(facts).toContainEqual({ label: 'Far from measured postures', value: '1' });
  expect(facts).toContainEqual({ label: 'Engagement lost', value: '2' });
});

it('ranks what is unstable first, then the gain that is left', () => {
  const ranked = { block: [1, 2, 3, 4, 5, 6], line: [1, 2, 3, 4, 5, 6], x_mm: [], y_mm: [], z_mm: [] };
  const numbers = {
    spectral_radius: [0.998, 0.99, 1.01, 1.2, 0.99, 0.99],
    gain_margin: [1.8, 1.1, 0.9, 0.5, null, 0.8],
    stability_margin: [-14.8, 0.1, -9, -1, 0.9, 0.3],
    limit_depth_mm: [2, 2, 2, 2, null, 2],
    lower_bound: [true, false, false, false, true, false],
  };
  const all = { ...ranked, ...numbers };
  expect(worstBlocks(all, 10).map((i) => all.block[i])).toEqual([4, 3, 6, 2, 1, 5]);
  expect(programFacts({ ...blocksSample, blocks: all })).toContainEqual({
    label: 'Nearest to chatter',
    value: 'block 4, gain margin 0.5',
  });
  expect(boundOf(all, 0)).toMatch(/^≥.2$/);
  expect(boundOf(all, 1)).toBe('2');
  expect(boundOf(all, 4)).toBe('none found');
});

it('thins long columns without losing an extreme or a gap', () => {
  const long = Array.from({ length: 40000 }, (_, i) => (i === 12345 ? 9 : i === 23456 ? -9 : i === 34567 ? null : Math.sin(i)));
  const keep = thinned([long], long.length);
  expect(keep.length).toBeLessThan(2300);
  for (const i of [0, 12345, 23456, 34567, 39999]) expect(keep).toContain(i);
  expect(thinned([long.slice(0, 100)], 100)).toHaveLength(100);
});
