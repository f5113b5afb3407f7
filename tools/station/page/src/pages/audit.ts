// #/audit shows the actions of users, #/audit/users their roles. Both need the role operator; only a command changes users.

import { nothing, render } from 'lit-html';
import { request } from '../api';
import type { Context, MakePage } from '../context';
import { csvTime } from '../csv';
import { bytes, fullTime, time } from '../format';
import { t, word } from '../i18n';
import { html } from '../markup';
import { PastList } from '../past';
import { channelLink } from '../router';
import { tabbedPage } from '../tabs';
import type { Tab } from '../tabs';
import type { AuditEntry, User } from '../types';
import { empty, errorText } from '../view';
import '../../styles/audit.css';

export const texts = {
  'audit.title': ['Audit', '审计'], 'audit.entries': ['Entries', '记录'], 'audit.users': ['Users', '用户'], 'audit.what': ['What', '操作'],
  'audit.target': ['Target', '对象'], 'audit.result': ['Result', '结果'], 'audit.bytes': ['Bytes to / from', '字节 发送/接收'],
  'audit.none': ['Nobody did anything in this time.', '此时段内没有任何操作。'], 'audit.not-allowed': ['This page needs the role operator.', '此页面需要操作员角色。'],
  'audit.user': ['User', '用户'], 'audit.role': ['Role', '角色'], 'audit.may': ['May', '权限'], 'audit.since': ['Since', '创建于'],
  'audit.no-users': ['There are no users.', '没有用户。'],
  'audit.users-hint': ['Users and tokens are changed on the station’s machine only, by these commands:', '用户和令牌只能在监控站所在的机器上用以下命令更改：'],
  'what.write': ['write', '写入'], 'what.acquire': ['read now', '立即读取'], 'what.login': ['login', '登录'], 'what.logout': ['logout', '退出'],
  'what.program': ['program', '编程'], 'what.acknowledge': ['acknowledge', '确认报警'], 'what.shelve': ['shelve', '搁置报警'],
  'what.unshelve': ['unshelve', '取消搁置'], 'what.maintenance': ['maintenance', '开始维护'], 'what.end maintenance': ['end maintenance', '结束维护'],
  'what.save dashboard': ['save dashboard', '保存仪表盘'], 'what.delete dashboard': ['delete dashboard', '删除仪表盘'],
  'what.save picture': ['save picture', '保存图片'], 'what.delete picture': ['delete picture', '删除图片'],
  'what.test notification': ['send test message', '发送测试消息'], 'what.save report': ['save report', '保存报表'], 'what.delete report': ['delete report', '删除报表'],
  'what.command': ['command', '命令'], 'what.user add': ['add user', '添加用户'], 'what.user remove': ['remove user', '删除用户'], 'may.viewer': ['look', '查看'],
  'may.operator': ['look, write, acknowledge', '查看、写入、确认'], 'may.programmer': ['look, write, acknowledge, program devices', '查看、写入、确认、设备编程'],
  'may.engineer': ['all of this, and change configurations and dashboards', '以上全部，并可修改配置和仪表盘'],
} as const;

// "write 1800", "acknowledge: looked at it": translates the action, and keeps the rest.
function whatText({ what }: AuditEntry): string {
  const [, head = what, rest = ''] = /^(end maintenance|test notification|user add|user remove|(?:save|delete) (?:dashboard|picture|report)|[a-z]+)(.*)$/s.exec(what) ?? [];
  return word('what', head) + rest;
}

const failed = (entry: AuditEntry): boolean => !/^(done|verified|ok|viewer|operator|programmer|engineer)?$/.test(entry.result);

// "a/b/c = 7": the channel, if it is in the catalogue.
function targetLink(context: Context, entry: AuditEntry): string {
  const path = entry.target.split(/[\s=]/, 1)[0] ?? '';
  return context.plant.ids.has(path) ? channelLink(path) : '';
}

const audit = (context: Context): PastList<AuditEntry> => new PastList<AuditEntry>(context, {
  label: t('audit.title'), className: 'audit-table', parts: [], path: '/api/audit', itemsOf: (answer) => answer['entries'] ?? [],
  tone: (entry) => (failed(entry) ? 'failed' : ''),
  textOf: (entry) => `${entry.who} ${entry.what} ${entry.target} ${entry.result}`,
  none: t('audit.none'), file: 'audit.csv', csvHead: ['at', 'who', 'what', 'target', 'bytes to device', 'bytes from device', 'result'],
  csvRow: (entry) => [csvTime(entry.at_ms), entry.who, entry.what, entry.target, entry.bytes_to_device, entry.bytes_from_device, entry.result],
  columns: [
    { key: 'at', label: t('alarms.at'), text: (entry) => fullTime(entry.at_ms) },
    { key: 'who', label: t('alarms.who'), text: (entry) => entry.who, hint: (entry) => entry.who },
    { key: 'what', label: t('audit.what'), text: whatText, hint: (entry) => entry.what },
    { key: 'target', label: t('audit.target'), text: (entry) => entry.target, hint: (entry) => entry.target, link: (entry) => targetLink(context, entry) },
    { key: 'result', label: t('audit.result'), text: (entry) => `${failed(entry) ? '▲ ' : ''}${word('result', entry.result)}`, hint: (entry) => entry.result },
    { key: 'bytes', label: t('audit.bytes'), text: (entry) => (entry.bytes_to_device || entry.bytes_from_device ? `${bytes(entry.bytes_to_device)} / ${bytes(entry.bytes_from_device)}` : '') },
  ],
});

class Users implements Tab {
  readonly element = document.createElement('div');
  readonly tools = document.createElement('p');
  private readonly asked = new AbortController();

  constructor(private readonly context: Context) {
    this.tools.className = 'muted';
    render(html`${t('audit.users-hint')} <code>fieldcast user add NAME --role operator</code> · <code>fieldcast user remove NAME</code> · <code>fieldcast token add NAME --days 365</code>`, this.tools);
    void this.load();
  }

  close(): void { this.asked.abort(); }

  private async load(): Promise<void> {
    if (!this.context.me.store) return void render(empty(t('history.no-store'), t('audit.no-users')), this.element);
    try {
      const { users } = await request<{ users: User[] }>('/api/users', undefined, this.asked.signal);
      render(users.length ? html`<div class="scroll" data-scroll tabindex="0" role="region" aria-label=${t('audit.users')}><table class="plain users">
        <thead><tr><th scope="col">${t('audit.user')}</th><th scope="col">${t('audit.role')}</th><th scope="col">${t('audit.may')}</th><th scope="col">${t('audit.since')}</th></tr></thead>
        <tbody>${users.map((user) => html`<tr><td><b>${user.user}</b></td><td>${word('role', user.role)}</td><td>${word('may', user.role)}</td>
          <td>${user.created_ms ? time(user.created_ms, this.context.now()) : nothing}</td></tr>`)}</tbody></table></div>` : empty(t('audit.no-users')), this.element);
    } catch (error) {
      if (!this.asked.signal.aborted) render(empty(errorText(error)), this.element);
    }
  }
}

function notAllowed(): Tab {
  const element = document.createElement('div');
  render(empty(t('audit.not-allowed')), element);
  return { element };
}

export const page: MakePage = (context) => tabbedPage(context, 'users', [t('audit.entries'), t('audit.users')], (users) =>
  !context.mayOperate() ? notAllowed() : users ? new Users(context) : audit(context));
