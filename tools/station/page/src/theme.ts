// Selects the light or dark theme: by the system, or by the user.

export type Theme = 'system' | 'light' | 'dark';
export const themes: readonly Theme[] = ['system', 'light', 'dark'];

export function theme(): Theme {
  const kept = localStorage.getItem('fieldcast.theme');
  return kept === 'light' || kept === 'dark' ? kept : 'system';
}

export function setTheme(next: Theme): void {
  if (next === 'system') localStorage.removeItem('fieldcast.theme');
  else localStorage.setItem('fieldcast.theme', next);
  applyTheme();
  dispatchEvent(new Event('fieldcast-theme'));
}

export function applyTheme(): void {
  const root = document.documentElement;
  if (theme() === 'system') delete root.dataset['theme'];
  else root.dataset['theme'] = theme();
}
