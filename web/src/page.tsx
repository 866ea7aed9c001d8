// The page: what to cut first, then what it rests on.
import { Component, type ComponentChildren } from 'preact';
import type { Assumption, Report } from './documents';
import { Facts, WarningBox } from './parts';
import { AssemblySection } from './sections/assembly';
import { AssumedBox } from './sections/assumed';
import { CellSection } from './sections/cell';
import { DecisionSection } from './sections/decision';
import { ForcesSection } from './sections/forces';
import { CoefficientsSection, JointSection, StiffnessSection } from './sections/identified';
import { FeedSection, LobesSection, PairsSection } from './sections/lobes';
import { CalibrationSection, MonitorSection } from './sections/monitor';
import { PeaksSection } from './sections/peaks';
import { ProgramSection } from './sections/program';
import { RecommendationSection } from './sections/recommendation';
import { RecordingsSection } from './sections/recordings';
import { SimulationSection } from './sections/simulation';
import { SmoothSection } from './sections/smooth';
import { FrfSection, HitsSection, ModesSection, NotesSection } from './sections/structure';
import { PosturesSection } from './sections/postures';
import { BoundarySection, ProbabilitySection, ResultsSection, SensitivitySection } from './sections/study';
import { ComparisonSection, SweepSection } from './sections/sweep';
import { ToolsSection } from './sections/tools';
import { Selection } from './selection';
import { frfsOf, hitsOf, lobesOf, modesOf } from './views';

interface Entry {
  id: string; // of the section's element
  name: string; // in the navigation
  content: ComponentChildren; // nothing where the report has nothing for it
}

function entries(report: Report): Entry[] {
  const { plan, monitor, calibration, forces, blocks, smooth, cell, assembly, recordings, files } = report;
  const { explanation, simulation, sweep, comparison, postures, tools, joint, coefficients, stiffness, study_points: points } = report;
  const { boundary, sensitivity = [], probability } = report.statistics ?? {};
  const { cuts = [], pairs = [], feed_directions: feed = [] } = plan ?? {};
  const notes = [...(plan?.notes ?? []), ...report.notes];
  const lobes = report.lobes && lobesOf(report.lobes);
  const modes = modesOf(report);
  const frfs = frfsOf(report);
  const hits = hitsOf(report);
  const all: Entry[] = [
    { id: 'monitor', name: 'Monitor', content: monitor && <MonitorSection monitor={monitor} /> },
    { id: 'calibration', name: 'Calibration', content: calibration && <CalibrationSection calibration={calibration} /> },
    { id: 'peaks', name: 'Peaks', content: explanation && <PeaksSection document={explanation} /> },
    { id: 'simulation', name: 'Cut in time', content: simulation && <SimulationSection simulation={simulation} vibration={report.vibration} /> },
    { id: 'lobes', name: 'Lobes', content: (lobes || cuts.length > 0) && <LobesSection lobes={lobes} plan={plan} document={report.lobes} /> },
    { id: 'sweep', name: 'Sweep', content: sweep && <SweepSection sweep={sweep} /> },
    { id: 'comparison', name: 'Methods', content: comparison && <ComparisonSection comparison={comparison} /> },
    { id: 'postures', name: 'Postures', content: postures && <PosturesSection document={postures} /> },
    { id: 'probability', name: 'Probability', content: probability && <ProbabilitySection result={probability} points={points} /> },
    { id: 'sensitivity', name: 'Sensitivity', content: sensitivity.length > 0 && <SensitivitySection rows={sensitivity} points={points} /> },
    { id: 'boundary', name: 'Boundary', content: boundary && <BoundarySection result={boundary} points={points} /> },
    { id: 'results', name: 'Results', content: points && points.values.length > 0 && points.keys.length > 0 && <ResultsSection points={points} /> },
    { id: 'feed', name: 'Feed direction', content: plan && feed.length > 0 && <FeedSection plan={plan} searched={lobes?.searched_depth_mm ?? null} /> },
    { id: 'program', name: 'Program', content: blocks && <ProgramSection document={blocks} /> },
    { id: 'forces', name: 'Forces', content: forces && <ForcesSection forces={forces} /> },
    { id: 'smooth', name: 'Smoothed program', content: smooth && <SmoothSection smooth={smooth} motion={report.motion} /> },
    { id: 'cell', name: 'Robot cell', content: cell && <CellSection document={cell} /> },
    { id: 'coefficients', name: 'Coefficients', content: coefficients && <CoefficientsSection document={coefficients} /> },
    { id: 'stiffness', name: 'Stiffness', content: stiffness && <StiffnessSection document={stiffness} /> },
    { id: 'tools', name: 'Tools', content: tools && <ToolsSection document={tools} /> },
    { id: 'joint', name: 'Joint', content: joint && <JointSection document={joint} /> },
    { id: 'assembly', name: 'Tool and holder', content: assembly && <AssemblySection document={assembly} /> },
    { id: 'frf', name: 'Frequency response', content: frfs.length > 0 && <FrfSection frfs={frfs} modes={modes} predicted={assembly !== null} /> },
    { id: 'modes', name: 'Modes', content: (modes.length > 0 || report.modes?.fit) && <ModesSection modes={modes} document={report.modes} /> },
    { id: 'pairs', name: 'Which modes matter', content: plan && lobes && pairs.length > 0 && <PairsSection all={lobes} plan={plan} /> },
    { id: 'recordings', name: 'Recorded cuts', content: recordings && <RecordingsSection recordings={recordings.recordings} /> },
    { id: 'hits', name: 'Hits', content: hits.length > 0 && <HitsSection hits={hits} /> },
    { id: 'notes', name: 'Notes', content: notes.length + files.length > 0 && <NotesSection notes={notes} files={files} /> },
  ];
  return all.filter(({ content }) => content);
}

/** A part that fails takes no other with it; it is tried again once it is about something else. */
export class Contained extends Component<{ children: ComponentChildren; about?: string }, { failed: string | null }> {
  override state = { failed: null };
  override componentDidCatch(error: unknown): void {
    console.error(error);
    this.setState({ failed: this.props.about ?? '' });
  }
  override render() {
    return this.state.failed === (this.props.about ?? '') ? <p class="notice">This section could not be shown.</p> : this.props.children;
  }
}

function Header({ title, created, plan, within }: Report & { within: boolean }) {
  return (
    <header>
      {within ? <h2>{title}</h2> : <h1>{title}</h1>}
      {created !== '' && <p class="created">{created}</p>}
      {plan?.facts && <Facts facts={plan.facts} />}
    </header>
  );
}

/** What the page does not say elsewhere: a decision has its own word on collisions. */
function assumedBeside({ assumed, cell, plan }: Report): Assumption[] {
  const all = [...assumed, ...(cell?.assumed ?? [])];
  return plan?.decision ? all.filter(({ key }) => key !== 'geometry') : all;
}

/** The numbers of the blocks whose places the page has. */
function placedBlocks({ blocks }: Report): number[] {
  return blocks?.blocks.block ?? [];
}

/** A report; `within` a page that has its own heading and main part. */
export function Page({ report, within = false }: { report: Report; within?: boolean }) {
  const { plan } = report;
  const decision = plan?.decision ?? null;
  const shown = entries(report);
  const Main = within ? 'div' : 'main';
  const links = decision ? [{ id: 'decision', name: 'Decision' }, ...shown] : shown;
  return (
    <Selection blocks={placedBlocks(report)}>
      {!within && (
        <a class="skip" href="#main">
          Skip to the content
        </a>
      )}
      <Header {...report} within={within} />
      {links.length > 1 && (
        <nav aria-label="Sections">
          {links.map(({ id, name }) => (
            <a href={`#${id}`}>{name}</a>
          ))}
        </nav>
      )}
      <Main id="main">
        {plan && decision && (
          <Contained>
            <DecisionSection decision={decision} plan={plan} />
          </Contained>
        )}
        {plan && <RecommendationSection plan={plan} hasLobes={report.lobes !== null} />}
        <WarningBox level="h2" heading="Before you use these numbers" texts={[...(decision ? [] : (plan?.warnings ?? [])), ...report.warnings]} />
        <AssumedBox assumed={assumedBeside(report)} />
        {shown.map(({ content }) => (
          <Contained>{content}</Contained>
        ))}
      </Main>
    </Selection>
  );
}
