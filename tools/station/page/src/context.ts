// The interface between a page and main.ts.

import type { Live } from './live';
import type { Plant, Topic } from './plant';
import type { Route } from './router';
import type { Me } from './types';

// Changes since the last painting.
export interface Change {
  values: boolean;  // at least one value changed
  second: boolean;  // a second has passed: update the ages
  topics: ReadonlySet<Topic>;
}

export interface Context {
  plant: Plant;
  live: Live;
  me: Me;
  route: Route;
  now(): number;  // the station's clock, Unix ms
  refusal(path: string): 'channel.needs-operator' | 'channel.no-commands' | undefined;  // why this user cannot write and read this channel now
  mayOperate(): boolean;  // the role allows writing and acknowledging
  mayEngineer(): boolean;  // the role allows changing configurations and dashboards
  go(address: string): void;  // '#/live'
  say(text: string, bad?: boolean): void;  // shows a short message that disappears
}

export interface Page {
  title?: string;  // otherwise its text NAME.title
  element: HTMLElement;
  paint?(change: Change): void;  // called in an animation frame; the first call must paint everything
  key?(event: KeyboardEvent): boolean;  // true: handled
  focusFilter?(): void;  // the key /
  close?(): void;
}

export type MakePage = (context: Context) => Page;
