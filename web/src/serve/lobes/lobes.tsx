// Lobes that answer while a slider moves.
import { useEffect, useState } from 'preact/hooks';
import type { Fact, SweepDocument } from '../../documents';
import { Bullets, Facts } from '../../parts';
import { fixed, percent, significant } from '../../text';
import { sweptOf } from '../../verb_views';
import { useServe } from '../context';
import { nameOf } from '../files/fields';
import { ErrorBox, Button, View } from '../pieces';
import { href } from '../route';
import { Chart } from './chart';
import { useLive, type Curves, type Live } from './live';
import { changesOf, differences, modesIn, pointFacts, rangesOf, resolved, stepOf, valueOf, type FileValues, type Point, type PointFacts, type Ranges, type Settings } from './settings';
import { sweptFacts, sweptKey, sweptRanges, type SweptFacts } from './swept';
import { ModeSwitches, Slider } from './sliders';
import { WriteBack } from './write_back';

const speedKey = 'operating_point.spindle_speed_rpm';

/** Of the second number of the operating point: a depth, or the value of what is swept. */
function secondKey({ sweep }: Curves): string {
  return sweep ? sweptKey(sweep) : 'operating_point.axial_depth_mm';
}

function rangesIn({ lobes, sweep }: Curves): Ranges {
  return sweep ? sweptRanges(sweep) : rangesOf(lobes);
}

/** "stable, margin 43 %"; the verdict also in words, not by colour alone. */
export function pointText({ stable, margin }: PointFacts): string {
  return `${stable ? 'stable' : 'chatter'}${margin === null ? '' : `, margin ${percent(margin, 0)}`}`;
}

function FactsPanel({ stable, evaluated, facts }: { stable: boolean; evaluated: boolean; facts: Fact[] }) {
  return (
    <div class="point-facts" data-evaluated={evaluated}>
      <span role="status" class={`verdict ${stable ? 'stable' : 'chatter'}`}>
        {stable ? 'stable' : 'chatter'}
      </span>
      <Facts facts={facts} />
    </div>
  );
}

function frequencyText({ frequency_hz, mode }: Pick<PointFacts, 'frequency_hz' | 'mode'>): string {
  return frequency_hz === null ? '–' : `${fixed(frequency_hz, 1)} Hz${mode === '' ? '' : `, ${mode}`}`;
}

export function PointPanel({ point: [speed, depth], facts }: { point: Point; facts: PointFacts }) {
  const { stable, limit_mm, searched_mm, margin } = facts;
  const entries = [
    { label: 'Spindle speed', value: `${fixed(speed, 0)} rpm` },
    { label: 'Axial depth', value: `${significant(depth)} mm` },
    { label: 'Limit here', value: limit_mm === null ? `none up to ${significant(searched_mm)} mm` : `${fixed(limit_mm, 3)} mm` },
    { label: 'Margin', value: percent(margin, 0) },
    { label: stable ? 'Chatter frequency above the limit' : 'Chatter frequency', value: frequencyText(facts) },
  ];
  return <FactsPanel stable={stable} evaluated={facts.evaluated} facts={entries} />;
}

/** The same in a sweep. */
export function SweptPanel({ point: [speed, value], facts, sweep }: { point: Point; facts: SweptFacts; sweep: SweepDocument }) {
  const { name, unit } = sweptOf(sweep);
  const entries = [
    { label: 'Spindle speed', value: `${fixed(speed, 0)} rpm` },
    { label: name, value: `${significant(value)} ${unit}` },
    { label: 'Spectral radius', value: fixed(facts.spectral_radius, 3) },
    { label: 'Stable here from', value: facts.intervals === '' ? 'nowhere' : `${facts.intervals} ${unit}` },
    { label: 'Chatter frequency', value: frequencyText(facts) },
  ];
  return <FactsPanel stable={facts.stable} evaluated={facts.evaluated} facts={entries} />;
}

interface ControlsProps {
  live: Live;
  file: FileValues;
  curves: Curves;
  locks: ReadonlySet<string>;
  lock: (key: string, locked: boolean) => void;
  first: Point;
}

function Controls({ live, file, curves, locks, lock, first }: ControlsProps) {
  const { settings, move, rest, error } = live;
  const ranges = rangesIn(curves);
  const depthKey = secondKey(curves);
  const slider = (key: string) => ({
    key,
    name: key,
    locked: locks.has(key),
    lock: (locked: boolean) => lock(key, locked),
    rest,
    wrong: error?.fault.field === key ? error.fault.text : null,
  });
  const [speed, depth] = settings.point ?? first;
  return (
    <div class="sliders">
      <fieldset>
        <legend>Operating point</legend>
        <Slider {...slider(speedKey)} value={speed} min={ranges.speed[0]} max={ranges.speed[1]} step={1} first={first[0]} move={(value, started) => move({ point: [value, depth] }, started)} />
        <Slider {...slider(depthKey)} value={depth} min={ranges.depth[0]} max={ranges.depth[1]} step={stepOf(ranges.depth)} first={first[1]} move={(value, started) => move({ point: [speed, value] }, started)} />
      </fieldset>
      {byTable(Object.keys(file.fields)).map(({ table, keys }) => (
        <fieldset key={table}>
          <legend>{nameOf(table).name}</legend>
          {keys.map((key) => (
            <Slider
              {...slider(key)}
              {...file.fields[key]!}
              value={valueOf(key, settings, file)}
              first={file.fields[key]!.value}
              move={(value, started) => move({ set: { ...live.settings.set, [key]: value } }, started)}
            />
          ))}
        </fieldset>
      ))}
      <ModeSwitches
        modes={live.answer?.modes ?? []}
        kept={modesIn(settings, file)}
        keep={(modes) => {
          move({ modes }, null);
          rest();
        }}
      />
    </div>
  );
}

function byTable(keys: string[]): { table: string; keys: string[] }[] {
  const tables = [...new Set(keys.map((key) => key.slice(0, key.lastIndexOf('.'))))];
  return tables.map((table) => ({ table, keys: keys.filter((key) => key.slice(0, key.lastIndexOf('.')) === table) }));
}

/** All but what is locked back to the file's values. */
export function resetAll(settings: Settings, locks: ReadonlySet<string>, first: Point, depthKey = 'operating_point.axial_depth_mm'): Settings {
  const set = Object.fromEntries(Object.entries(settings.set).filter(([key]) => locks.has(key)));
  const [speed, depth] = settings.point ?? first;
  return { set, modes: null, point: [locks.has(speedKey) ? speed : first[0], locks.has(depthKey) ? depth : first[1]] };
}

function Moving({ live, curves, file, point, path }: { live: Live; curves: Curves; file: FileValues; point: Point; path: string }) {
  const [kept, setKept] = useState<Curves | null>(null);
  const [locks, setLocks] = useState<ReadonlySet<string>>(new Set());
  const [first] = useState(point);
  const { sweep } = curves;
  const depthKey = secondKey(curves);
  const facts = pointFacts(point, curves.lobes, curves.limit, live.points);
  const swept = sweep && sweptFacts(point, sweep, live.points);
  const [name, keptName] = kept ? differences(curves.settings, kept.settings, file) : ['limit', ''];
  const changes = changesOf(live.settings, file);
  const lock = (key: string, locked: boolean) => setLocks(new Set(locked ? [...locks, key] : [...locks].filter((one) => one !== key)));
  const written = () => {
    const fields = Object.fromEntries(Object.entries(file.fields).map(([key, field]) => [key, { ...field, value: valueOf(key, live.settings, file) }]));
    live.wrote({ fields, modes: modesIn(live.settings, file) });
  };
  const reset = () => {
    live.move(resetAll(live.settings, locks, first, depthKey), null);
    live.rest();
  };
  return (
    <div class="live">
      <div class="live-chart">
        {sweep && swept ? <SweptPanel point={point} facts={swept} sweep={sweep} /> : <PointPanel point={point} facts={facts} />}
        <Chart
          curves={curves}
          name={name}
          kept={kept && { curves: kept, name: keptName }}
          point={point}
          ranges={rangesIn(curves)}
          says={`${fixed(point[0], 0)} rpm, ${significant(point[1])} ${sweep ? sweptOf(sweep).unit : 'mm'}, ${swept ? (swept.stable ? 'stable' : 'chatter') : pointText(facts)}`}
          move={([speed, depth], started) => live.move({ point: [locks.has(speedKey) ? point[0] : speed, locks.has(depthKey) ? point[1] : depth] }, started)}
          rest={live.rest}
        />
        <Bullets texts={live.answer?.notes ?? []} />
      </div>
      <div class="live-controls">
        <ErrorBox error={live.error} />
        <div class="buttons">
          <Button act={() => setKept({ ...curves, settings: resolved(curves.settings, file) })}>Keep this curve</Button>
          {kept && <Button act={() => setKept(null)}>Remove the kept one</Button>}
          <Button act={reset}>Reset all</Button>
          <WriteBack path={path} changes={changes} written={written} />
        </div>
        <Controls live={live} file={file} curves={curves} locks={locks} lock={lock} first={first} />
      </div>
    </div>
  );
}

function LobesOf({ path }: { path: string }) {
  const { api, folder } = useServe();
  const live = useLive(api, path);
  const { curves, file, error, settings, retry } = live;
  // The files are told anew when one changes and when the server is back: what failed may succeed.
  useEffect(() => {
    if (error !== null && curves === null) retry();
  }, [folder?.files]);
  return (
    <View heading={path} lead="">
      {curves && file && settings.point ? <Moving live={live} curves={curves} file={file} point={settings.point} path={path} /> : <ErrorBox error={error} />}
      {error && !curves && <Button act={retry}>Try again</Button>}
      {!curves && !error && <p class="notice">The first curve is being computed.</p>}
      <p>
        <a href={href('job', path)}>Edit {path}</a>
      </p>
    </View>
  );
}

/** Without a file: which one. */
export function LobesView({ path }: { path: string }) {
  const all = useServe().folder?.files ?? [];
  const cuts = all.filter(({ kind }) => kind === 'lobes');
  const files = cuts.length > 0 ? cuts : all.filter(({ kind }) => kind === 'job'); // which contain the cut
  const chosen = path === '' && files.length === 1 ? files[0]!.path : path;
  if (chosen !== '') return <LobesOf key={chosen} path={chosen} />;
  return (
    <View heading="Lobes" lead="How deep the cutter may go at each spindle speed before chatter starts, while the sliders move.">
      {files.length === 0 ? (
        <p class="notice">
          The folder has no job. <code>robomill init job -o job.toml</code> writes one to fill in, with <code>--example</code> one that runs.
        </p>
      ) : (
        <ul>
          {files.map((file) => (
            <li>
              <a href={href('lobes', file.path)}>{file.path}</a>
            </li>
          ))}
        </ul>
      )}
    </View>
  );
}
