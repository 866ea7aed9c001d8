// Spindles that are monitored: as many as eight, one of them in full.
import { useEffect, useRef, useState } from 'preact/hooks';
import { Table } from '../../parts';
import { dash, fixed } from '../../text';
import { useServe } from '../context';
import { newest } from '../later';
import { Button, ErrorBox, View } from '../pieces';
import { href } from '../route';
import type { MonitorMessage, MonitorSummary } from './documents';
import { monitorFeed, type MonitorFeed } from './feed';
import { Spindle, StateBadge } from './spindle';
import { StartMonitor } from './start';
import { News } from './news';
import { StopQuestion, useStop } from './stop';
import { chatterText, isOver, nameOf } from './text';

const shown_ms = 200; // numbers change no faster than they can be read
const said_ms = 2000;

/** The newest of what was said, in the place of what the list had. */
export function withMessage(summary: MonitorSummary, message: MonitorMessage | undefined): MonitorSummary {
  if (message === undefined || message.frame.clock_s < (summary.frame?.clock_s ?? 0)) return summary;
  const { alarms, ...now } = message;
  return { ...summary, ...now };
}

/** Says at most one change of state in two seconds. */
function useNews(feed: MonitorFeed, name: (id: number) => string | null): void {
  const { announce } = useServe();
  useEffect(() => {
    const news = new News();
    let timer: ReturnType<typeof setTimeout> | undefined;
    const say = () => {
      const text = news.next();
      timer = text === null ? undefined : setTimeout(say, said_ms);
      if (text !== null) announce(text);
    };
    const end = feed.messages.listen(({ id, frame }) => {
      const named = name(id);
      if (named === null) return news.forget(id);
      news.take(id, named, frame);
      if (timer === undefined) say();
    });
    return () => {
      clearTimeout(timer);
      end();
    };
  }, [feed]);
}

/** The sessions of the server with their newest frames; null: not known yet. */
function useMonitors(feed: MonitorFeed): MonitorSummary[] | null {
  const { api } = useServe();
  const [list, setList] = useState<MonitorSummary[] | null>(null);
  const [, setTick] = useState(0);
  const messages = useRef(new Map<number, MonitorMessage>());
  const known = useRef(list);
  known.current = list;
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    const { ask, stop } = newest(
      api.monitors,
      (now) => {
        for (const id of messages.current.keys()) if (!now.some((one) => one.id === id)) messages.current.delete(id);
        setList(now);
      },
      (error) => console.warn(error), // the page says that the server is down
    );
    const ends = [
      feed.changes.listen(ask),
      feed.reconnected.listen(ask),
      feed.messages.listen((message) => {
        if (!known.current?.some(({ id }) => id === message.id)) return;
        messages.current.set(message.id, message);
        timer ??= setTimeout(() => {
          timer = undefined;
          setTick((tick) => tick + 1);
        }, shown_ms);
      }),
    ];
    ask();
    return () => {
      stop();
      clearTimeout(timer);
      for (const end of ends) end();
    };
  }, [feed]);
  useNews(feed, (id) => {
    const one = known.current?.find((summary) => summary.id === id);
    return one === undefined ? null : nameOf(one);
  });
  return list && list.map((summary) => withMessage(summary, messages.current.get(summary.id)));
}

interface SpindlesProps {
  spindles: MonitorSummary[];
  selected: number | null;
  ending: ReadonlySet<number>; // ids of those that are being ended
  stop: (summary: MonitorSummary) => void;
}

export function Spindles({ spindles, selected, ending, stop }: SpindlesProps) {
  return (
    <Table
      caption="Spindles"
      quiet
      rows={spindles}
      rowClass={({ id }) => (id === selected ? 'selected' : '')}
      rowKey={({ id }) => id}
      columns={[
        {
          heading: 'Spindle',
          cell: (spindle) => (
            <a href={href('monitor', String(spindle.id))} aria-current={spindle.id === selected ? 'true' : undefined}>
              {nameOf(spindle)}
            </a>
          ),
        },
        { heading: 'State', cell: (spindle) => <StateBadge summary={spindle} /> },
        { heading: 'Speed (rpm)', number: true, cell: ({ frame }) => fixed(frame?.spindle_speed_rpm ?? null, 0) },
        { heading: 'Suggested (rpm)', number: true, cell: ({ frame }) => fixed(frame?.suggested_spindle_speed_rpm ?? null, 0) },
        { heading: 'Chatter at', number: true, cell: ({ frame }) => (frame ? chatterText(frame) : dash) },
        { heading: 'Alarms', number: true, cell: ({ alarm_count: count }) => fixed(count, 0) },
        {
          heading: '',
          cell: (spindle) => (
            <Button act={() => stop(spindle)} disabled={ending.has(spindle.id)} label={`${isOver(spindle) ? 'Remove' : 'Stop'} ${nameOf(spindle)}`}>
              {isOver(spindle) ? 'Remove' : 'Stop'}
            </Button>
          ),
        },
      ]}
    />
  );
}

/** `path`: the number of a spindle, a monitor.toml to begin with, or empty. */
export function MonitorView({ path, feed = monitorFeed }: { path: string; feed?: MonitorFeed }) {
  const spindles = useMonitors(feed);
  const { ending, asked, error, press, end, keep } = useStop(spindles, path);
  const isNumber = /^\d+$/.test(path);
  const selected = spindles?.find(({ id, config }) => (isNumber ? String(id) === path : path === '' || config === path)) ?? null;
  return (
    <View heading="Monitor" lead="Chatter while cutting, from recordings as if they were cut now or from streams. This page looks on: nothing is commanded and nothing is written.">
      <ErrorBox error={error} />
      {spindles !== null && spindles.length > 0 && (
        <section aria-label="Spindles">
          <Spindles spindles={spindles} selected={selected?.id ?? null} ending={ending} stop={press} />
        </section>
      )}
      {asked.what && <StopQuestion key={asked.times} asked={asked.what} end={end} keep={keep} />}
      {spindles !== null && isNumber && !selected && <p class="notice">There is no spindle {path}, or it was ended.</p>}
      {selected && <Spindle key={selected.id} summary={selected} feed={feed} since={isOver(selected) ? 'over' : selected.status} />}
      <StartMonitor key={isNumber ? '' : path} path={isNumber ? '' : path} />
    </View>
  );
}
