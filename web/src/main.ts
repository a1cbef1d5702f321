// The page begins here.

import { Page } from "./page.ts";
import { keepOffline } from "./offline.ts";

const root = document.getElementById("page");
if (root !== null) {
    void new Page(root).begin();
    keepOffline();
}
