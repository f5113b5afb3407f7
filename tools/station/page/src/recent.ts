// The channels that were looked at last, newest first, kept by the browser.

const keptUnder = 'fieldcast.recent';
const most = 12;

export function recentChannels(): string[] {
  try {
    const kept = JSON.parse(localStorage.getItem(keptUnder) ?? '[]') as unknown;
    return Array.isArray(kept) ? kept.filter((path) => typeof path === 'string').slice(0, most) : [];
  } catch {
    return [];
  }
}

export function noteRecent(path: string): void {
  localStorage.setItem(keptUnder, JSON.stringify([path, ...recentChannels().filter((each) => each !== path)].slice(0, most)));
}
