// Programming: devices and modules, the user and start of each session, and how to start one. #/programming/BUS/DEVICE
// shows the command for one device.

import { nothing, render } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { endSession } from '../alarm_actions';
import type { Change, Context, MakePage } from '../context';
import { pathOf } from '../device_health';
import { age, bytes, count, fullTime } from '../format';
import { t, word } from '../i18n';
import { ListTable } from '../list';
import { html } from '../markup';
import { portCommand, serverOf } from '../port_command';
import type { PortChoice } from '../port_command';
import { link } from '../router';
import { SplitPage } from '../split_page';
import type { Device, Session } from '../types';
import { badge, empty } from '../view';
import type { Tone } from '../view';
import '../../styles/programming.css';

export const texts = {
  'programming.title': ['Programming', '编程'], 'programming.table': ['Devices and modules, and who programs them', '设备与模块，以及正在编程的人员'],
  'programming.hint': ['The vendor’s software programs a PLC through the bridge. While it does, the bus of that PLC rests.', '厂商软件通过网桥对 PLC 编程。编程期间，该 PLC 所在的总线暂停。'],
  'programming.state': ['Session', '会话'], 'programming.free': ['free', '空闲'], 'programming.to': ['To it', '发送'],
  'programming.from': ['From it', '接收'], 'programming.rate': ['Rate', '速率'], 'programming.request': ['Last request', '最近请求'], 'programming.one-open': ['One device is programmed now', '当前有一台设备正在编程'],
  'programming.open': ['{n} devices are programmed now', '当前有 {n} 台设备正在编程'],
  'programming.by': ['{who} has been programming it for {age}.', '{who} 已编程 {age}。'],
  'programming.last': ['Programmed last by {who}.', '上次编程：{who}。'],
  'programming.never': ['Nobody has programmed it since its bridge started.', '自网桥启动以来无人编程。'],
  'programming.passes': ['{rate} now; {to} to it and {from} from it in all.', '当前 {rate}；共发送 {to}，接收 {from}。'],
  'programming.requested': ['Last request, {age} ago: {request}', '{age}前的最近请求：{request}'],
  'programming.meanwhile': ['What rests meanwhile', '期间暂停的内容'],
  'programming.no-bus': ['This module has no bus. Nothing rests while it is programmed.', '此模块没有总线，编程期间不影响其他内容。'],
  'programming.rests': ['The whole bus {bus}: {devices} devices with {channels} channels. Their values become uncertain, commands are refused with LEASED. Other buses go on.', '整条总线 {bus}：{devices} 台设备、{channels} 个通道。其数值变为不确定，命令以 LEASED 被拒绝。其他总线不受影响。'],
  'programming.start': ['Start', '开始'],
  'programming.start-hint': ['Run this on the PC with the programming software. Then choose the virtual port in that software.', '在装有编程软件的电脑上运行此命令，然后在软件中选择该虚拟串口。'],
  'programming.command': ['Command', '命令'], 'programming.copy': ['Copy', '复制'],
  'programming.copied': ['The command is in the clipboard.', '命令已复制到剪贴板。'],
  'programming.copy-by-hand': ['The browser does not allow it. The command is selected: copy it by hand.', '浏览器不允许复制。命令已选中，请手动复制。'],
  'programming.server': ['Bridge', '网桥'],
  'programming.server-hint': ['host:port, as program: engineers: listen: of the bridge says', '主机:端口，与网桥配置 program: engineers: listen: 一致'],
  'programming.number': ['Device number', '设备号'],
  'programming.number-hint': ['number: of the device in the bridge’s configuration', '网桥配置中该设备的 number:'],
  'programming.port': ['Virtual port', '虚拟串口'], 'programming.port-hint': ['on Linux a path that is made; on Windows a COM port: COM5', 'Linux：将创建的路径；Windows：COM 端口，如 COM5'],
  'programming.user': ['User', '用户'], 'programming.user-hint': ['with the role programmer, and the password in the named file; empty: no login', '需要 programmer 角色，密码在所示文件中；留空则不登录'],
  'programming.tls': ['By TLS', '使用 TLS'],
  'programming.end-hint': ['Ctrl-C ends it. The bridge also takes the device back after ten minutes without a byte.', '按 Ctrl-C 结束。十分钟没有数据时，网桥也会收回设备。'],
  'programming.end': ['End the session', '结束会话'], 'programming.end-title': ['End the session of {device}', '结束 {device} 的会话'],
  'programming.end-warning': ['{who} loses the connection at once. A program that is half transmitted can leave the PLC stopped.', '{who} 将立即断开。传输到一半的程序可能使 PLC 停机。'],
  'programming.ended': ['The session of {device} was ended.', '{device} 的会话已结束。'],
  'session.open': ['programming', '编程中'], 'session.closed': ['ended', '已结束'], 'session.refused': ['refused', '被拒绝'],
} as const;

const dialIn = 'dial-in';  // stands for the bus of a module without one
const keptUnder = 'fieldcast.port';

interface Target {
  bus: string;
  device: string;
  known: Device | undefined;  // a device of a bus
  session: Session | undefined;  // the present one, or the last
}

const tones: Record<string, Tone> = { open: 'warning', refused: 'bad', closed: 'unknown' };
const shapes: Record<string, string> = { open: '◆', refused: '▲' };
const isOpen = (target: Target): boolean => target.session?.state === 'open';

function read(): Record<string, string> {
  try {
    return JSON.parse(localStorage.getItem(keptUnder) ?? '{}') as Record<string, string>;
  } catch {
    return {};
  }
}

class ProgrammingPage extends SplitPage {
  private readonly hint = document.createElement('p');
  private readonly list: ListTable<Target>;
  private choice: PortChoice | undefined;

  constructor(context: Context) {
    super(context, t('programming.start'));
    this.hint.className = 'muted';
    this.hint.textContent = t('programming.hint');
    const now = (): number => context.now();
    this.list = new ListTable<Target>({
      label: t('programming.table'), className: 'session-table', keyOf: pathOf,
      tone: (target) => (isOpen(target) ? 'd-warning' : target.session?.state === 'refused' ? 'd-bad' : 'd-unknown'),
      open: (target) => context.go(link('programming', [target.bus, target.device])),
      columns: [
        { key: 'state', label: t('programming.state'), text: ({ session }) => (session ? `${shapes[session.state] ?? '○'} ${word('session', session.state)}` : `○ ${t('programming.free')}`) },
        { key: 'device', label: t('devices.device'), text: pathOf, link: (target) => link('programming', [target.bus, target.device]) },
        { key: 'who', label: t('alarms.who'), text: ({ session }) => session?.who ?? '', hint: ({ session }) => session?.who ?? '' },
        { key: 'since', label: t('alarms.since'), text: ({ session }) => (session?.since_ms ? age(now() - session.since_ms) : ''), hint: ({ session }) => (session?.since_ms ? fullTime(session.since_ms) : '') },
        { key: 'to', label: t('programming.to'), text: ({ session }) => (session ? bytes(session.bytes_to_device) : '') },
        { key: 'from', label: t('programming.from'), text: ({ session }) => (session ? bytes(session.bytes_from_device) : '') },
        { key: 'rate', label: t('programming.rate'), text: (target) => this.rate(target) },
        { key: 'request', label: t('programming.request'), text: ({ session }) => session?.last_request ?? '', hint: ({ session }) => (session?.last_request_ms ? fullTime(session.last_request_ms) : '') },
      ],
    });
    this.body.append(this.list.element, this.note, this.details);
    this.element.append(this.head, this.hint, this.body);
  }

  override paint(change: Change): void {
    if (!change.second && !change.topics.has('sessions') && !change.topics.has('bridges')) return;
    const targets = this.targets();
    this.list.set(targets);
    if (this.chosen) this.list.select(this.chosen);
    const open = targets.filter(isOpen).length;
    render(html`<h1>${t('programming.title')}</h1><span role="status">${badge(open ? 'warning' : 'unknown', open === 1 ? t('programming.one-open') : t('programming.open', { n: open }))}</span>`, this.head);
    this.body.classList.toggle('none', !targets.length);
    render(targets.length ? nothing : empty(t('devices.none')), this.note);
    if (this.chosen) this.drawDetails(targets.find((target) => pathOf(target) === this.chosen));
  }

  key(event: KeyboardEvent): boolean {
    if (event.key === 'c' && this.choice) void this.copy();
    else if (event.key === 'Backspace' && this.chosen) this.context.go(link('programming'));
    else return this.list.key(event);
    return true;
  }

  // Devices of buses and dialled-in modules; those with a session are first.
  private targets(): Target[] {
    const { devices, sessions } = this.context.plant;
    const found = new Map<string, Target>();
    for (const [path, known] of devices) found.set(path, { bus: known.bus, device: known.device, known, session: sessions.get(path) });
    for (const [path, session] of sessions) if (!found.has(path)) found.set(path, { bus: session.bus, device: session.device, known: undefined, session });
    return [...found.values()].sort((a, b) => Number(isOpen(b)) - Number(isOpen(a)) || pathOf(a).localeCompare(pathOf(b)));
  }

  private rate(target: Target): string {
    if (!isOpen(target)) return '';
    return `${bytes(Math.round(this.context.plant.rates.of(pathOf(target), performance.now())))}/s`;
  }

  private firstChoice(target: Target): PortChoice {
    const kept = read();
    const bridge = [...this.context.plant.bridges.values()].find((each) => each.buses.some(({ bus }) => bus === target.bus));
    return {
      server: kept[`server ${target.bus}`] ?? serverOf(bridge?.host || location.hostname), number: kept[`number ${pathOf(target)}`] ?? target.device,
      port: kept['port'] ?? '/tmp/plc', user: kept['user'] ?? '', tls: kept['tls'] === 'yes',
    };
  }

  private keep(target: Target, choice: PortChoice): void {
    localStorage.setItem(keptUnder, JSON.stringify({
      ...read(), [`server ${target.bus}`]: choice.server, [`number ${pathOf(target)}`]: choice.number, port: choice.port, user: choice.user, tls: choice.tls ? 'yes' : 'no' }));
  }

  private async copy(): Promise<void> {
    if (!this.choice) return;
    try {
      await navigator.clipboard.writeText(portCommand(this.choice));
      this.context.say(t('programming.copied'));
    } catch {
      getSelection()?.selectAllChildren(this.details.querySelector('.command')!);
      this.context.say(t('programming.copy-by-hand'), true);
    }
  }

  private drawDetails(target: Target | undefined): void {
    if (!target) {
      render(html`<a class="back" href=${link('programming')}>‹ ${t('programming.title')}</a>${empty(t('devices.unknown', { device: this.chosen }))}`, this.details);
      return;
    }
    const { session } = target;
    const choice = (this.choice ??= this.firstChoice(target));
    const change = (event: Event): void => {
      const input = event.target as HTMLInputElement;
      this.choice = { ...choice, [input.name]: input.type === 'checkbox' ? input.checked : input.value.trim() };
      this.keep(target, this.choice);
      this.drawDetails(target);
    };
    const field = (name: 'server' | 'number' | 'port' | 'user', hint: string): TemplateResult => html`<label class="field">${t(`programming.${name}`)}
      <input name=${name} .value=${choice[name]} spellcheck="false" autocapitalize="none" autocomplete="off"><span class="muted">${hint}</span></label>`;
    render(html`<a class="back" href=${link('programming')}>‹ ${t('programming.title')}</a>
      <header><h2>${pathOf(target)}</h2>${session ? badge(tones[session.state] ?? 'unknown', word('session', session.state)) : nothing}</header>
      <p class="reason">${session && isOpen(target) ? t('programming.by', { who: session.who, age: age(this.context.now() - session.since_ms) }) :
        session ? t('programming.last', { who: session.who }) : t('programming.never')}</p>
      ${session && isOpen(target) ? html`<p class="reason">${t('programming.passes', { rate: this.rate(target), to: bytes(session.bytes_to_device), from: bytes(session.bytes_from_device) })}</p>` : nothing}
      ${session?.last_request && session.last_request_ms ? html`<p class="reason">${t('programming.requested', { request: session.last_request, age: age(this.context.now() - session.last_request_ms) })}</p>` : nothing}
      ${session && isOpen(target) && this.context.mayOperate() ? html`<p class="links"><button type="button" @click=${() => void endSession(this.context, target.bus, target.device, session.who)}>${t('programming.end')}</button></p>` : nothing}
      <h3>${t('programming.meanwhile')}</h3><p>${this.meanwhile(target)}</p>
      <h3>${t('programming.start')}</h3><p class="muted">${t('programming.start-hint')}</p>
      <pre class="command" data-scroll tabindex="0" aria-label=${t('programming.command')}>${portCommand(choice)}</pre>
      <p class="links"><button type="button" class="primary" @click=${() => void this.copy()}>${t('programming.copy')} <kbd>c</kbd></button></p>
      <div class="fields" @input=${change}>${field('server', t('programming.server-hint'))}${field('number', t('programming.number-hint'))}
        ${field('port', t('programming.port-hint'))}${field('user', t('programming.user-hint'))}
        <label><input type="checkbox" name="tls" .checked=${choice.tls}>${t('programming.tls')}</label></div>
      <p class="muted">${t('programming.end-hint')}</p>`, this.details);
  }

  private meanwhile(target: Target): string {
    if (target.bus === dialIn) return t('programming.no-bus');
    const { plant } = this.context;
    const channels = plant.count().get(target.bus)?.all ?? 0;
    const devices = [...plant.devices.values()].filter((device) => device.bus === target.bus).length;
    return t('programming.rests', { bus: target.bus, devices: count(devices), channels: count(channels) });
  }
}

export const page: MakePage = (context) => new ProgrammingPage(context);
