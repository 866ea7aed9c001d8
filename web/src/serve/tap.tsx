// A guided tap test: hits as they are made, what they add up to, and how many are still needed.
import { useEffect, useRef, useState } from 'preact/hooks';
import type { FrfDocument } from '../documents';
import { prefersLogFrequency } from '../figures/frf';
import { Bullets, Table } from '../parts';
import { Choice, Plot } from '../plot';
import { fixed, significant, withPower } from '../text';
import { frfsOf, type Frf } from '../views';
import { useAction, useServe } from './context';
import type { Tap, TapHit, TapPeak } from './documents';
import { Button, ErrorBox, Labelled, Panel, Select, View } from './pieces';
import { tapFigure, type Earlier } from './tap_figure';

/** "3 of 5 good hits; 2 more". */
export function countText({ good, wanted }: Pick<Tap, 'good' | 'wanted'>): string {
  const more = wanted - good;
  return `${good} of ${wanted} good ${wanted === 1 ? 'hit' : 'hits'}; ${more > 0 ? `${more} more` : 'that is enough'}`;
}

export function HitsTable({ taken }: { taken: TapHit[] }) {
  return (
    <Table
      caption="Hits, the newest first"
      rows={[...taken].reverse()}
      rowClass={({ accepted }) => (accepted ? '' : 'rejected')}
      columns={[
        { heading: 'File', cell: ({ file }) => file },
        { heading: 'Force', cell: ({ force_direction }) => force_direction },
        { heading: 'Used', cell: ({ accepted }) => (accepted ? 'yes' : <strong>no</strong>) },
        { heading: 'Why', long: true, cell: ({ reasons }) => reasons.join('; ') },
      ]}
    />
  );
}

export function PeaksTable({ peaks }: { peaks: TapPeak[] }) {
  return (
    <Table
      caption="Peaks"
      rows={peaks}
      columns={[
        { heading: 'FRF', cell: ({ name }) => name },
        { heading: 'Frequency (Hz)', number: true, cell: ({ frequency_hz }) => fixed(frequency_hz, 1) },
        { heading: 'Receptance (m/N)', number: true, cell: ({ receptance_m_per_n }) => withPower(receptance_m_per_n) },
        { heading: 'Coherence', number: true, cell: ({ coherence }) => significant(coherence) },
      ]}
    />
  );
}

function frfsIn(frf: FrfDocument | null): Frf[] {
  if (frf === null) return [];
  return frfsOf({ frf: { ...frf, coherence: frf.coherence ?? {} }, fitted: null, measured: null, modes: null, assembly: null });
}

const most_earlier = 6;

/** The averages before the last, to see them settle. */
function useEarlier({ good, frf }: Tap): Earlier[] {
  const [earlier, setEarlier] = useState<Earlier[]>([]);
  const last = useRef<Earlier | null>(null);
  useEffect(() => {
    const before = last.current;
    if (before && before.hits < good) setEarlier([...earlier, before].slice(-most_earlier));
    if (good === 0) setEarlier([]);
    last.current = good > 0 && frf ? { hits: good, frfs: frfsIn(frf) } : null;
  }, [good, frf]);
  return earlier;
}

function TapPlot({ tap }: { tap: Tap }) {
  const frfs = frfsIn(tap.frf);
  const earlier = useEarlier(tap);
  const [shown, setShown] = useState(0);
  const [logarithmic, setLogarithmic] = useState<boolean | null>(null);
  const frf = frfs[Math.min(shown, frfs.length - 1)];
  if (!frf) return <p class="notice">The first good hit draws the frequency response.</p>;
  const log = logarithmic ?? prefersLogFrequency(frf);
  return (
    <Plot
      which="tap"
      shows="Frequency response of the hits so far: magnitude, phase and coherence"
      caption="Thin lines are the averages of fewer hits; coherence near 1 means the hits agree."
      draw={(theme) => tapFigure(frf, earlier, log, theme)}
    >
      <Choice legend="FRF" names={frfs.map(({ name }) => name)} chosen={Math.min(shown, frfs.length - 1)} choose={setShown} />
      <Choice legend="Frequency" names={['linear', 'logarithmic']} chosen={Number(log)} choose={(chosen) => setLogarithmic(chosen === 1)} />
    </Plot>
  );
}

function Newest({ hit }: { hit: TapHit | undefined }) {
  if (!hit) return <p>Hit the tool tip with the hammer; the next file that appears is taken.</p>;
  return (
    <p class={hit.accepted ? 'good' : 'error'}>
      {hit.file}: {hit.accepted ? 'accepted' : 'rejected'}
      {hit.reasons.length > 0 && `; ${hit.reasons.join('; ')}`}
    </p>
  );
}

export function TapShown({ tap }: { tap: Tap }) {
  const newest = tap.taken[tap.taken.length - 1];
  return (
    <>
      <Panel heading={countText(tap)} name="tap-count">
        <progress max={tap.wanted} value={Math.min(tap.good, tap.wanted)} aria-label="Good hits" />
        <div role="status" aria-live="polite">
          <Newest hit={newest} />
        </div>
        {!tap.running && <p class="notice">The tap test is over.</p>}
      </Panel>
      <section aria-label="Frequency response">
        <h2>Frequency response</h2>
        <TapPlot tap={tap} />
        {tap.peaks.length > 0 && <PeaksTable peaks={tap.peaks} />}
      </section>
      {tap.taken.length > 0 && (
        <section aria-label="Hits">
          <HitsTable taken={tap.taken} />
        </section>
      )}
    </>
  );
}

function Start({ path }: { path: string }) {
  const { api, folder, tookTap, announce } = useServe();
  const { busy, error, act } = useAction();
  const files = (folder?.files ?? []).filter(({ kind }) => kind === 'hits');
  const [chosen, choose] = useState(path);
  const [watch, setWatch] = useState('');
  const [wanted, setWanted] = useState('');
  const hits = chosen || files[0]?.path || '';
  const start = async () => {
    tookTap((await api.startTap(hits, watch.trim(), Number(wanted) || 0)).state);
    announce('The tap test has begun');
  };
  if (files.length === 0) return <p class="notice">A tap test needs a hits.toml with the columns and sensors of your recordings. Drop one of them on the page: robomill asks and writes it.</p>;
  return (
    <Panel heading="Begin" name="tap-start">
      <div class="buttons">
        <Select label="Settings" value={hits} options={files.map((file) => ({ value: file.path, name: file.path }))} choose={choose} />
        <Labelled label="Folder to watch (empty: that of the settings)">
          <input type="text" value={watch} spellcheck={false} autocomplete="off" onInput={({ currentTarget }) => setWatch(currentTarget.value)} />
        </Labelled>
        <Labelled label="Good hits (empty: five a direction)">
          <input type="number" min={1} max={200} step={1} value={wanted} onInput={({ currentTarget }) => setWanted(currentTarget.value)} />
        </Labelled>
        <Button main act={() => void act(start)} disabled={busy || hits === ''}>
          Start
        </Button>
      </div>
      <Bullets texts={['Each file that appears there is one hit.', 'A hit that is double, overloaded or too weak is rejected, with the reason.']} />
      <ErrorBox error={error} />
    </Panel>
  );
}

export function TapView({ path }: { path: string }) {
  const { api, tap, tookTap, announce } = useServe();
  const { busy, error, act } = useAction();
  const end = async () => {
    await api.endTap();
    tookTap(null);
    announce('The tap test was ended');
  };
  return (
    <View heading="Tap test" lead={tap ? `With the settings of ${tap.hits}.` : 'Hammer hits from files that appear in a folder, one by one, until there are enough good ones.'}>
      {tap ? (
        <>
          <div class="buttons">
            <Button act={() => void act(end)} disabled={busy}>
              End the tap test
            </Button>
          </div>
          <ErrorBox error={error} />
          <TapShown tap={tap} />
        </>
      ) : (
        <Start key={path} path={path} />
      )}
    </View>
  );
}
