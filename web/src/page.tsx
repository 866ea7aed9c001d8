// The page: what to cut first, then what it rests on.
import { Component, type ComponentChildren } from 'preact';
import type { Report } from './documents';
import { Bullets, Facts } from './parts';
import { AssemblySection } from './sections/assembly';
import { DecisionSection } from './sections/decision';
import { ForcesSection } from './sections/forces';
import { FeedSection, LobesSection, PairsSection } from './sections/lobes';
import { CalibrationSection, MonitorSection } from './sections/monitor';
import { ProgramSection } from './sections/program';
import { RecommendationSection } from './sections/recommendation';
import { RecordingsSection } from './sections/recordings';
import { SmoothSection } from './sections/smooth';
import { FrfSection, HitsSection, ModesSection, NotesSection } from './sections/structure';
import { Selection } from './selection';
import { frfsOf, hitsOf, lobesOf, modesOf } from './views';

interface Entry {
  id: string; // of the section's element
  name: string; // in the navigation
  content: ComponentChildren; // nothing where the report has nothing for it
}

function entries(report: Report): Entry[] {
  const { plan, monitor, calibration, forces, blocks, smooth, assembly, recordings, files } = report;
  const { cuts = [], pairs = [], feed_directions: feed = [], notes = [] } = plan ?? {};
  const lobes = report.lobes && lobesOf(report.lobes);
  const modes = modesOf(report);
  const frfs = frfsOf(report);
  const hits = hitsOf(report);
  const all: Entry[] = [
    { id: 'monitor', name: 'Monitor', content: monitor && <MonitorSection monitor={monitor} /> },
    { id: 'calibration', name: 'Calibration', content: calibration && <CalibrationSection calibration={calibration} /> },
    { id: 'lobes', name: 'Lobes', content: (lobes || cuts.length > 0) && <LobesSection lobes={lobes} plan={plan} /> },
    { id: 'feed', name: 'Feed direction', content: plan && feed.length > 0 && <FeedSection plan={plan} searched={lobes?.searched_depth_mm ?? null} /> },
    { id: 'program', name: 'Program', content: blocks && <ProgramSection document={blocks} /> },
    { id: 'forces', name: 'Forces', content: forces && <ForcesSection forces={forces} /> },
    { id: 'smooth', name: 'Smoothed program', content: smooth && <SmoothSection smooth={smooth} motion={report.motion} /> },
    { id: 'assembly', name: 'Tool and holder', content: assembly && <AssemblySection document={assembly} /> },
    { id: 'frf', name: 'Frequency response', content: frfs.length > 0 && <FrfSection frfs={frfs} modes={modes} predicted={assembly !== null} /> },
    { id: 'modes', name: 'Modes', content: (modes.length > 0 || report.modes?.fit) && <ModesSection modes={modes} document={report.modes} /> },
    { id: 'pairs', name: 'Which modes matter', content: plan && lobes && pairs.length > 0 && <PairsSection all={lobes} plan={plan} /> },
    { id: 'recordings', name: 'Recorded cuts', content: recordings && <RecordingsSection recordings={recordings} /> },
    { id: 'hits', name: 'Hits', content: hits.length > 0 && <HitsSection hits={hits} /> },
    { id: 'notes', name: 'Notes', content: notes.length + files.length > 0 && <NotesSection notes={notes} files={files} /> },
  ];
  return all.filter(({ content }) => content);
}

/** A section that fails takes no other with it. */
class Contained extends Component<{ children: ComponentChildren }, { failed: boolean }> {
  override state = { failed: false };
  override componentDidCatch(error: unknown): void {
    console.error(error);
    this.setState({ failed: true });
  }
  override render() {
    return this.state.failed ? <p class="notice">This section could not be shown.</p> : this.props.children;
  }
}

function Header({ title, created, plan }: Report) {
  return (
    <header>
      <h1>{title}</h1>
      {created !== '' && <p class="created">{created}</p>}
      {plan?.facts && <Facts facts={plan.facts} />}
    </header>
  );
}

function Warnings({ warnings }: { warnings: string[] }) {
  if (warnings.length === 0) return null;
  return (
    <aside class="warnings" aria-label="Warnings">
      <h2>Before you use these numbers</h2>
      <Bullets texts={warnings} />
    </aside>
  );
}

/** The numbers of the blocks whose places the page has. */
function placedBlocks({ blocks }: Report): number[] {
  return blocks?.blocks.block ?? [];
}

export function Page({ report }: { report: Report }) {
  const { plan } = report;
  const decision = plan?.decision ?? null;
  const shown = entries(report);
  const links = decision ? [{ id: 'decision', name: 'Decision' }, ...shown] : shown;
  return (
    <Selection blocks={placedBlocks(report)}>
      <a class="skip" href="#main">
        Skip to the content
      </a>
      <Header {...report} />
      {links.length > 1 && (
        <nav aria-label="Sections">
          {links.map(({ id, name }) => (
            <a href={`#${id}`}>{name}</a>
          ))}
        </nav>
      )}
      <main id="main">
        {plan && decision && (
          <Contained>
            <DecisionSection decision={decision} plan={plan} />
          </Contained>
        )}
        {plan && <RecommendationSection plan={plan} hasLobes={report.lobes !== null} />}
        {plan && !decision && <Warnings warnings={plan.warnings} />}
        {shown.map(({ content }) => (
          <Contained>{content}</Contained>
        ))}
      </main>
    </Selection>
  );
}
