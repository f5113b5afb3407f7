// Entry point: login, the shown page, keys, and the one loop that paints. Received values only mark changes; an animation frame
// paints them, so a fast plant costs at most one painting for each frame of the screen.

import { request } from './api';
import { BrowserNotices, showNotice } from './browser_notices';
import type { Change, Context, Page } from './context';
import { setLanguage, t } from './i18n';
import { nextTurn } from './kiosk';
import { Live } from './live';
import { pageOf } from './pages';
import { Plant } from './plant';
import type { CatalogueAnswer, Topic } from './plant';
import { meter } from './meter';
import { parseRoute } from './router';
import type { Route } from './router';
import { Shell } from './shell';
import { applyTheme } from './theme';
import type { Me } from './types';
import '../app.css';  // after the styles of the pages

const plant = new Plant();
const connection = new Live(plant);
let me: Me | undefined;
let shown: Page | undefined;
let route = parseRoute(location.hash);
let fresh = true;  // the page has not been painted yet
let second = false;
let values = 0;  // plant.samples at the last painting
let scheduled = false;
let rotation = 0;
const shortestTurn_s = 3, usualTurn_s = 20;

const shell = new Shell(plant, connection, {
  logout: async () => {
    connection.stop();
    await request('/api/logout', {}).catch(() => undefined);
    await start();
  },
  chooseLanguage: (next) => {
    setLanguage(next);
    shell.build(me);
    showPage();
  },
});

const allTopics: ReadonlySet<Topic> = new Set<Topic>(['catalogue', 'buses', 'devices', 'alarms', 'sessions', 'bridges', 'plans', 'sites', 'connection']);

function paint(): void {
  scheduled = false;
  const topics = fresh ? allTopics : new Set(plant.changed);
  const change: Change = { values: fresh || plant.samples !== values, second: fresh || second, topics };
  values = plant.samples;
  plant.changed.clear();
  second = fresh = false;
  shell.paint(change);
  shown?.paint?.(change);
}

function schedule(): void {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(paint);
}

function context(of: Route): Context {
  return {
    plant, live: connection, route: of, me: me!,
    now: () => connection.now(),
    refusal: (path) => !me?.role || me.role === 'viewer' ? 'channel.needs-operator' :
      plant.sites.has(path.split(':')[0]!) && !plant.stream?.commands ? 'channel.no-commands' : undefined,
    mayOperate: () => !!me?.role && me.role !== 'viewer',
    mayEngineer: () => me?.role === 'engineer',
    go: (address) => { location.hash = address; },
    say: (text, bad) => shell.say(text, bad),
  };
}

function showPage(): void {
  if (!me) return;
  shown?.close?.();
  route = parseRoute(location.hash);
  const name = me.role === null ? 'login' : route.name === 'login' || !pageOf(route.name) ? 'overview' : route.name;
  shown = pageOf(name)!.module.page(context(route));
  rotate();
  fresh = true;
  shell.show(name, route, shown);
  schedule();
}

function rotate(): void {
  clearTimeout(rotation);
  const next = nextTurn(route, (name) => pageOf(name) !== undefined);
  if (next === undefined) return;
  const every_s = Math.max(shortestTurn_s, Number(route.query.get('every')) || usualTurn_s);
  rotation = window.setTimeout(() => { location.hash = next; }, every_s * 1000);
}

// A wall screen's link has its token behind the #, which is not sent to a server. It is removed from the address immediately.
async function loginByLink(): Promise<void> {
  const { query } = parseRoute(location.hash);
  const token = query.get('token');
  if (!token) return;
  query.delete('token');
  const rest = query.toString();
  window.history.replaceState(null, '', `${location.hash.split('?', 1)[0]}${rest ? `?${rest}` : ''}`);
  await request('/api/login', { token }).catch((error: unknown) => shell.say(String((error as Error).message), true));
}

async function start(): Promise<void> {
  await loginByLink();
  const asked = request<Me>('/api/me');
  // Starts before the response arrives: usually the user is logged in, or no login is needed.
  const early = request<CatalogueAnswer>('/api/catalogue');
  early.catch(() => undefined);
  try {
    me = await asked;
  } catch {
    shell.build(undefined);
    shell.say(t('error.lost'), true);
    setTimeout(() => void start(), 2000);
    return;
  }
  connection.clock.observe(me.now_ms);
  shell.build(me);
  showPage();
  if (me.role !== null) connection.start(early);
}

plant.onChange = schedule;
const notices = new BrowserNotices(showNotice);
plant.onAlarm = (alarm) => notices.see(alarm, connection.now());
meter.now = () => connection.now();
connection.onLoginRequired = () => {
  connection.stop();
  void start();
};
setInterval(() => {
  second = true;
  plant.recent.take(plant.value, plant.quality, performance.now());
  schedule();
}, 1000);
addEventListener('hashchange', showPage);
addEventListener('fieldcast-login', () => void start());
shell.listenToKeys(() => shown);
applyTheme();
void start();
