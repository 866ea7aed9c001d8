// A guided tap test: hits as they are made, what they add up to, and how many are still needed.
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import type { FrfDocument } from '../../documents';
import { prefersLogFrequency } from '../../figures/frf';
import type { Theme } from '../../figures/theme';
import { Table } from '../../parts';
import { Choice, LogChoice, Plot } from '../../plot';
import { fixed, significant } from '../../text';
import { frfsOf, type Frf } from '../../views';
import { Confirm, useAsked } from '../confirm';
import { useAction, useServe } from '../context';
import type { Tap, TapHit, TapPeak } from '../documents';
import { Button, ErrorBox, Panel, View } from '../pieces';
import { tapFigure, type Earlier } from './figure';
import { Hits, Overlay } from './hits';
import { SavePanel, unsavedText } from './save';
import { Start } from './start';
import { StreamPanel } from './stream';

/** "3 of 5 good hits; 2 more". */
export function countText({ good, wanted }: Pick<Tap, 'good' | 'wanted'>): string {
  const more = wanted - good;
  return `${good} of ${wanted} good ${wanted === 1 ? 'hit' : 'hits'}; ${more > 0 ? `${more} more` : 'that is enough'}`;
}

export function PeaksTable({ peaks }: { peaks: TapPeak[] }) {
  return (
    <Table
      caption="Peaks"
      rows={peaks}
      columns={[
        { heading: 'FRF', cell: ({ name }) => name },
        { heading: 'Frequency (Hz)', number: true, cell: ({ frequency_hz }) => fixed(frequency_hz, 1) },
        { heading: 'Receptance (µm/N)', number: true, cell: ({ receptance_m_per_n: size }) => significant(size === null ? null : 1e6 * size) },
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

/** The averages of fewer hits, each once: of what is left out again there is none. */
export function withEarlier(earlier: Earlier[], before: Earlier | null, good: number): Earlier[] {
  const fewer = earlier.filter(({ hits }) => hits < good && hits !== before?.hits);
  return [...fewer, ...(before && before.hits < good ? [before] : [])].slice(-most_earlier);
}

/** The averages before the last, to see them settle. */
function useEarlier({ id, good, frf }: Tap): Earlier[] {
  const [earlier, setEarlier] = useState<Earlier[]>([]);
  const last = useRef<{ id: number; average: Earlier | null }>({ id, average: null });
  useEffect(() => {
    const same = last.current.id === id;
    setEarlier((known) => withEarlier(same ? known : [], same ? last.current.average : null, good));
    last.current = { id, average: good > 0 && frf ? { hits: good, frfs: frfsIn(frf) } : null };
  }, [id, good, frf]);
  return earlier;
}

function TapPlot({ tap }: { tap: Tap }) {
  const frfs = useMemo(() => frfsIn(tap.frf), [tap.frf]);
  const earlier = useEarlier(tap);
  const [shown, setShown] = useState(0);
  const [logarithmic, setLogarithmic] = useState<boolean | null>(null);
  const frf = frfs[Math.min(shown, frfs.length - 1)];
  const log = logarithmic ?? (frf !== undefined && prefersLogFrequency(frf));
  // The same until there is something else to draw: another one draws all of it anew.
  const draw = useMemo(() => frf && ((theme: Theme) => tapFigure(frf, earlier, log, theme)), [frf, earlier, log]);
  if (!draw) return <p class="notice">The first good hit draws the frequency response.</p>;
  return (
    <Plot
      which="tap"
      shows="Frequency response of the hits so far: magnitude, phase and coherence"
      caption="Thin lines are the averages of fewer hits; coherence near 1 means the hits agree."
      draw={draw}
    >
      <Choice legend="FRF" names={frfs.map(({ name }) => name)} chosen={Math.min(shown, frfs.length - 1)} choose={setShown} />
      <LogChoice legend="Frequency" logarithmic={log} choose={setLogarithmic} />
    </Plot>
  );
}

function Newest({ hit, streams }: { hit: TapHit | undefined; streams: boolean }) {
  if (!hit) return <p>Hit the tool tip with the hammer; {streams ? 'each hit in the stream' : 'the next file that appears'} is taken.</p>;
  return (
    <p class={hit.accepted ? 'good' : 'error'}>
      {hit.file}: {hit.accepted ? 'accepted' : hit.excluded ? 'left out by hand' : 'rejected'}
      {hit.reasons.length > 0 && `; ${hit.reasons.join('; ')}`}
    </p>
  );
}

export function TapShown({ tap, wrote }: { tap: Tap; wrote: (accepted: string) => void }) {
  const newest = tap.taken[tap.taken.length - 1];
  return (
    <>
      <Panel heading={countText(tap)} name="tap-count">
        <progress max={tap.wanted} value={Math.min(tap.good, tap.wanted)} aria-label="Good hits" />
        {tap.waiting && tap.waiting.length > 0 && <span class="quiet">waiting for the other file of {tap.waiting.join(', ')}</span>}
        <div role="status" aria-live="polite">
          <Newest hit={newest} streams={tap.stream !== null} />
        </div>
        {!tap.running && <p class="notice">The tap test is over.</p>}
      </Panel>
      {tap.stream && <StreamPanel tap={tap} stream={tap.stream} />}
      <Panel heading="Frequency response">
        <TapPlot tap={tap} />
        {tap.peaks.length > 0 && <PeaksTable peaks={tap.peaks} />}
      </Panel>
      {tap.taken.length > 0 && (
        <Panel heading="Hits">
          <Overlay tap={tap} />
          <Hits tap={tap} />
        </Panel>
      )}
      {tap.taken.length > 0 && <SavePanel key={tap.id} tap={tap} wrote={wrote} />}
    </>
  );
}

export function TapView({ path }: { path: string }) {
  const { api, tap, tookTap, announce } = useServe();
  const { busy, error, act } = useAction();
  const [saved, setSaved] = useState<string | null>(null);
  const [asked, ask] = useAsked<number>(); // of which test
  const wrote = (accepted: string) => {
    setSaved(accepted);
    ask(null);
  };
  const lost = tap && unsavedText(tap, saved);
  const end = async () => {
    ask(null);
    await api.endTap();
    tookTap(null);
    announce('The tap test was ended');
  };
  return (
    <View heading="Tap test" lead={tap ? `With the settings of ${tap.hits}.` : 'Hammer hits from files that appear in a folder or from a stream, one by one, until there are enough good ones.'}>
      {tap ? (
        <>
          <div class="buttons">
            <Button act={() => (lost === null ? void act(end) : ask(tap.id))} disabled={busy}>
              End the tap test
            </Button>
          </div>
          {asked.what === tap.id && lost !== null && (
            <Confirm key={asked.times} heading="End the tap test?" yes="End without saving" no="Go on" act={() => void act(end)} cancel={() => ask(null)}>
              {lost}
            </Confirm>
          )}
          <ErrorBox error={error} />
          <TapShown tap={tap} wrote={wrote} />
        </>
      ) : (
        <Start key={path} path={path} />
      )}
    </View>
  );
}
