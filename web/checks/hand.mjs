// A hand at an open page: mouse, keys and files as real input events.
const codes = { Tab: 9, Enter: 13, Escape: 27, ' ': 32, PageUp: 33, PageDown: 34, End: 35, Home: 36, ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40, Backspace: 8, Delete: 46 };
const texts = { Enter: '\r', ' ': ' ' };

/** Two frames: what an event changed is drawn. */
export async function settle(page) {
  await page.evaluate(`new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))`);
}

function mouse(page, type, { x, y }, button = 'left', buttons = 0) {
  return page.send('Input.dispatchMouseEvent', { type, x, y, button, buttons, clickCount: type === 'mouseMoved' ? 0 : 1 });
}

/** The middle of an element, after it was scrolled into view; `at` is a share of its width and height. */
export async function placeOf(page, selector, at = [0.5, 0.5]) {
  const found = await page.evaluate(`(() => {
    const element = document.querySelector(${JSON.stringify(selector)});
    if (!element) return null;
    document.documentElement.style.scrollBehavior = 'auto';
    element.scrollIntoView({ block: 'center' });
    const { x, y, width, height } = element.getBoundingClientRect();
    return { x: x + ${at[0]} * width, y: y + ${at[1]} * height, width, height };
  })()`);
  if (!found) throw new Error(`nothing is at ${selector}`);
  return found;
}

/** The pointer rests before it presses: a plot is told first what is under it. */
export async function clickAt(page, place) {
  await mouse(page, 'mouseMoved', place, 'none');
  await settle(page);
  await mouse(page, 'mousePressed', place, 'left', 1);
  await mouse(page, 'mouseReleased', place);
  await settle(page);
}

export async function click(page, selector) {
  await clickAt(page, await placeOf(page, selector));
}

/** Clicks the first button within a selector that is enabled and begins with these words. */
export async function button(page, words, within = '#view') {
  const found = await page.evaluate(`(() => {
    for (const one of document.querySelectorAll('[data-wanted]')) delete one.dataset.wanted;
    const all = [...document.querySelectorAll(${JSON.stringify(`${within} button`)})];
    const one = all.find(({ textContent, disabled }) => textContent.startsWith(${JSON.stringify(words)}) && !disabled);
    if (one) one.dataset.wanted = 'true';
    return one !== undefined;
  })()`);
  if (!found) throw new Error(`there is no button "${words}" to press in ${within}`);
  await click(page, '[data-wanted]');
}

/** Chooses in the list whose label begins with these words. */
export async function choose(page, label, value, within = '#view') {
  const found = await page.evaluate(`(() => {
    const labels = [...document.querySelectorAll(${JSON.stringify(`${within} label`)})];
    const select = labels.find(({ textContent }) => textContent.startsWith(${JSON.stringify(label)}))?.querySelector('select');
    if (![...(select?.options ?? [])].some((option) => option.value === ${JSON.stringify(value)})) return false;
    select.value = ${JSON.stringify(value)};
    select.dispatchEvent(new Event('change', { bubbles: true }));
    return true;
  })()`);
  if (!found) throw new Error(`there is no ${value} among "${label}" in ${within}`);
}

/** Presses at a place, moves in steps of about a frame, and lets go; resolves when the last event was sent. */
export async function drag(page, from, to, { steps = 40, pause_ms = 16, held = async () => {} } = {}) {
  await mouse(page, 'mouseMoved', from, 'none');
  await mouse(page, 'mousePressed', from, 'left', 1);
  for (let i = 1; i <= steps; ++i) {
    const share = i / steps;
    const sent = mouse(page, 'mouseMoved', { x: from.x + share * (to.x - from.x), y: from.y + share * (to.y - from.y) }, 'left', 1);
    await Promise.all([sent, new Promise((resolve) => setTimeout(resolve, pause_ms))]);
  }
  await held();
  await mouse(page, 'mouseReleased', to);
}

/** The same with a finger. */
export async function swipe(page, from, to, steps = 15) {
  const touch = (type, touchPoints) => page.send('Input.dispatchTouchEvent', { type, touchPoints });
  await page.send('Emulation.setTouchEmulationEnabled', { enabled: true });
  await touch('touchStart', [from]);
  for (let i = 1; i <= steps; ++i) await touch('touchMove', [{ x: from.x + (i / steps) * (to.x - from.x), y: from.y + (i / steps) * (to.y - from.y) }]);
  await touch('touchEnd', []);
  await page.send('Emulation.setTouchEmulationEnabled', { enabled: false });
  await settle(page);
}

/** A key by its name; `modifiers`: 1 Alt, 2 Control, 8 Shift. */
export async function press(page, key, modifiers = 0) {
  const named = { key, code: key === ' ' ? 'Space' : key, windowsVirtualKeyCode: codes[key] ?? key.toUpperCase().charCodeAt(0), modifiers };
  const text = modifiers & 2 ? undefined : (texts[key] ?? (key.length === 1 ? key : undefined));
  await page.send('Input.dispatchKeyEvent', { type: text === undefined ? 'rawKeyDown' : 'keyDown', ...named, ...(text === undefined ? {} : { text }) });
  await page.send('Input.dispatchKeyEvent', { type: 'keyUp', ...named });
  await settle(page);
}

/** Types into what has the focus. */
export function type(page, text) {
  return page.send('Input.insertText', { text });
}

/** What a control held is selected, replaced and committed. */
export async function fill(page, selector, text) {
  await click(page, selector);
  await page.evaluate(`document.activeElement.select()`);
  await type(page, text);
  await press(page, 'Enter');
}

/** Files of this machine, as if they had been chosen in the file input. */
export async function chooseFiles(page, selector, files) {
  const { root } = await page.send('DOM.getDocument', { depth: 0 });
  const { nodeId } = await page.send('DOM.querySelector', { nodeId: root.nodeId, selector });
  await page.send('DOM.setFileInputFiles', { nodeId, files });
}

/** Files dragged from outside over the middle of an element and let go there. */
export async function dropFiles(page, selector, files) {
  const { x, y } = await placeOf(page, selector);
  const data = { items: [], files, dragOperationsMask: 1 };
  for (const type of ['dragEnter', 'dragOver', 'drop']) await page.send('Input.dispatchDragEvent', { type, x, y, data });
  await settle(page);
}
