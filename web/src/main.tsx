import { render } from 'preact';
import { Page } from './page';
import { isConfig, requireReport } from './parse';
import { drawAll, drawOnEvents } from './plot';
import { App } from './serve/app';

/** What stands in the page as data, by its id; null where it is not there. */
function dataIn(id: string): unknown {
  return JSON.parse(document.getElementById(id)?.textContent ?? 'null');
}

function pageOf(report: unknown) {
  requireReport(report);
  return <Page report={report} />;
}

/** A report has its data in the page; the application that `robomill serve` answers with has a token instead, and asks. */
async function start(): Promise<void> {
  const root = document.getElementById('page')!;
  const config = dataIn('serve-config');
  const served = isConfig(config);
  render(served ? <App config={config} /> : pageOf(dataIn('report-data')), root);
  const place = served ? '' : window.location.hash.slice(1);
  if (place !== '') document.getElementById(place)?.scrollIntoView();
  drawOnEvents();
  await drawAll();
  document.documentElement.dataset['plots'] = 'ready';
}

start().catch((error: unknown) => {
  document.getElementById('page')!.textContent = `This page could not be shown. ${error instanceof Error ? error.message : ''}`;
  console.error(error);
});
