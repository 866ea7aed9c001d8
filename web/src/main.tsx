import { render } from 'preact';
import type { Report } from './documents';
import { Page } from './page';
import { drawAll, drawOnEvents } from './plot';
import { App } from './serve/app';
import type { ServeConfig } from './serve/documents';

/** What stands in the page as data, by its id; null where it is not there. */
function dataIn<T>(id: string): T | null {
  const element = document.getElementById(id);
  return element && (JSON.parse(element.textContent ?? 'null') as T);
}

/** A report has its data in the page; the application that `robomill serve` answers with has a token instead, and asks. */
async function start(): Promise<void> {
  const root = document.getElementById('page')!;
  const config = dataIn<ServeConfig>('serve-config');
  if (config) render(<App config={config} />, root);
  else render(<Page report={dataIn<Report>('report-data')!} />, root);
  const place = config ? '' : window.location.hash.slice(1);
  if (place !== '') document.getElementById(place)?.scrollIntoView();
  drawOnEvents();
  await drawAll();
  document.documentElement.dataset['plots'] = 'ready';
}

start().catch((error: unknown) => {
  document.getElementById('page')!.textContent = 'This page could not be shown.';
  console.error(error);
});
