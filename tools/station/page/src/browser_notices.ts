// Notifications of this browser: one for each alarm that becomes unacknowledged while the page is open, also in a tab in the background.
// The user chooses them for this browser.

import { word, t } from './i18n';
import { alarmKey } from './plant';
import { link } from './router';
import type { Alarm } from './types';

const keptUnder = 'fieldcast.notices';
const settling_ms = 3000;  // alarms that arrive first are already shown by the page
const burst = { most: 3, within_ms: 10_000 };  // further ones become one notification

export const canNotify = (): boolean => 'Notification' in window && window.isSecureContext;
export const isNotifying = (): boolean => canNotify() && Notification.permission === 'granted' && localStorage.getItem(keptUnder) === 'on';

// Returns whether notifications are now shown. Asks for the permission of the browser if needed.
export async function chooseNotices(on: boolean): Promise<boolean> {
  localStorage.removeItem(keptUnder);
  if (!on || await Notification.requestPermission() !== 'granted') return false;
  localStorage.setItem(keptUnder, 'on');
  return true;
}

export class BrowserNotices {
  private readonly seen = new Map<string, number>();  // start of the newest occurrence, by alarm
  private first_ms: number | undefined;
  private recent: number[] = [];  // when the last ones were shown

  constructor(private readonly show: (title: string, options: NotificationOptions, address: string) => void) {}

  see(alarm: Alarm, now_ms: number): void {
    const key = alarmKey(alarm);
    this.first_ms ??= now_ms;
    if (alarm.state === 'acknowledged' || alarm.state === 'clear') return void this.seen.delete(key);
    if (alarm.state !== 'unacknowledged' || alarm.suppressed || (alarm.shelved_until_ms ?? 0) > now_ms) return;
    if (this.seen.get(key) === alarm.since_ms) return;
    this.seen.set(key, alarm.since_ms);
    if (now_ms - this.first_ms < settling_ms || !isNotifying()) return;
    this.recent = [...this.recent.filter((at) => now_ms - at < burst.within_ms), now_ms];
    const path = `${alarm.bus}/${alarm.device}/${alarm.channel}`;
    if (this.recent.length > burst.most)
      this.show(t('alarms.notice-many', { n: this.recent.length }), { tag: 'fieldcast' }, link('alarms'));
    else
      this.show(`${word('priority', alarm.priority)}: ${path} ${word('limit', alarm.limit)}`, { tag: key }, link('alarms', [], { alarm: key }));
  }
}

export function showNotice(title: string, options: NotificationOptions, address: string): void {
  const notice = new Notification(title, options);
  notice.onclick = () => {
    window.focus();
    location.hash = address;
    notice.close();
  };
}
