/** Starts the studio with the settings that stand in the page. */

import type { Settings } from "./settings";
import { Studio } from "./studio";

const settings = JSON.parse(document.getElementById("settings")!.textContent!) as Settings;
(window as unknown as { studio: Studio }).studio = new Studio(settings);
