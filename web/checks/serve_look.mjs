// Looks at a view of the application: reached by the keyboard alone, named, of enough contrast, not too wide.
import { press, settle } from './hand.mjs';

/** Runs in the page: the controls that a keyboard must reach; of a group of radio buttons one. */
function controls() {
  const groups = new Set();
  const wanted = [...document.querySelectorAll('a[href], button, input, select, textarea, summary, [tabindex="0"]')].filter((element) => {
    if (element.disabled || element.tabIndex < 0 || !element.checkVisibility()) return false;
    if (element.type !== 'radio') return true;
    if (groups.has(element.name)) return false;
    groups.add(element.name);
    return true;
  });
  wanted.forEach((element, i) => (element.dataset.walk = element.type === 'radio' ? `radio ${element.name}` : String(i)));
  for (const radio of document.querySelectorAll('input[type=radio]')) radio.dataset.walk = `radio ${radio.name}`;
  return wanted.map((element) => ({ walk: element.dataset.walk, name: element.outerHTML.slice(0, 110) }));
}

/** Runs in the page: which control has the focus, and whether one sees that. */
function focused() {
  const element = document.activeElement;
  if (!element || element === document.body) return null;
  const outlined = (one) => one && getComputedStyle(one).outlineStyle !== 'none' && parseFloat(getComputedStyle(one).outlineWidth) >= 1;
  const { top, bottom, left, right } = element.getBoundingClientRect();
  const inside = bottom > 0 && top < window.innerHeight && right > 0 && left < window.innerWidth;
  return { walk: element.dataset.walk ?? '', seen: inside && [element, element.nextElementSibling, element.closest('.editor')].some(outlined), name: element.outerHTML.slice(0, 110) };
}

/** Tab goes to every control, and each shows that it has the focus. Gives how many. */
export async function walk(page, where, problems) {
  const wanted = await page.evaluate(`(${controls})()`);
  await page.evaluate(`document.activeElement?.blur(); window.scrollTo(0, 0); window.getSelection().removeAllRanges()`);
  const visited = new Set();
  for (let i = 0; i < 2 * wanted.length + 5 && visited.size < wanted.length; ++i) {
    await press(page, 'Tab');
    const now = await page.evaluate(`(${focused})()`);
    if (now === null || now.walk === '') continue;
    if (!visited.has(now.walk) && !now.seen) problems.push(`${where}: the focus is not seen at ${now.name}`);
    visited.add(now.walk);
  }
  for (const { walk: one, name } of wanted) if (!visited.has(one)) problems.push(`${where}: Tab does not reach ${name}`);
  return wanted.length;
}

const named = new Set(['button', 'link', 'checkbox', 'radio', 'slider', 'spinbutton', 'textbox', 'combobox', 'progressbar', 'navigation', 'image']);

/** Every control has a name for a screen reader. */
export async function names(page, where, problems) {
  await page.send('Accessibility.enable', {});
  const { nodes } = await page.send('Accessibility.getFullAXTree', {});
  for (const { ignored, role, name, backendDOMNodeId } of nodes) {
    if (ignored || !named.has(role?.value?.toLowerCase()) || (name?.value ?? '').trim() !== '') continue;
    const { node } = await page.send('DOM.describeNode', { backendNodeId: backendDOMNodeId }).catch(() => ({ node: null }));
    if (node?.nodeName === 'svg') continue; // Plotly's own
    problems.push(`${where}: a ${role.value} has no name: ${node?.nodeName} ${(node?.attributes ?? []).join(' ').slice(0, 90)}`);
  }
  await page.send('Accessibility.disable', {});
}

/** Runs in the page: texts whose contrast is below AA. Disabled controls and plots are not counted. */
function faint() {
  const parse = (colour) => {
    const [r, g, b, a = 1] = colour.match(/[\d.]+/g).map(Number);
    return colour.startsWith('color(srgb') ? [255 * r, 255 * g, 255 * b, a] : [r, g, b, a];
  };
  const over = ([r, g, b, a], [R, G, B]) => [a * r + (1 - a) * R, a * g + (1 - a) * G, a * b + (1 - a) * B, 1];
  const behind = (element) => {
    const layers = [];
    for (let one = element; one; one = one.parentElement) layers.push(parse(getComputedStyle(one).backgroundColor));
    return layers.reverse().reduce((below, layer) => over(layer, below), [255, 255, 255, 1]);
  };
  const luminance = (colour) => {
    const [r, g, b] = colour.slice(0, 3).map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const found = [];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const element = texts.currentNode.parentElement;
    if (!texts.currentNode.textContent.trim() || !element.checkVisibility() || element.closest('svg, script, noscript, .quiet, .skip, :disabled')) continue;
    const style = getComputedStyle(element);
    const ground = behind(element);
    const [light, dark] = [luminance(over(parse(style.color), ground)), luminance(ground)].sort((a, b) => b - a);
    const large = parseFloat(style.fontSize) >= 24 || (parseFloat(style.fontSize) >= 18.66 && Number(style.fontWeight) >= 700);
    const ratio = (light + 0.05) / (dark + 0.05);
    if (ratio < (large ? 3 : 4.5)) found.push(`${ratio.toFixed(2)} to 1 in "${texts.currentNode.textContent.trim().slice(0, 40)}" (${element.tagName.toLowerCase()}.${element.className})`);
  }
  return [...new Set(found)];
}

export async function contrast(page, where, problems) {
  for (const one of await page.evaluate(`(${faint})()`)) problems.push(`${where}: contrast ${one}`);
}

/** Nothing is wider than the window. */
export async function width(page, where, problems) {
  await settle(page);
  const { scroll, inner } = await page.evaluate(`({ scroll: document.documentElement.scrollWidth, inner: window.innerWidth })`);
  if (scroll > inner) problems.push(`${where}: ${scroll} px wide in a window of ${inner} px`);
}
