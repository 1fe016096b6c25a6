// Starts `denavit lsp`, and shows what the editor cannot: tables, comparisons and the robot beside the file.

import { execFile } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";
import * as vscode from "vscode";
import { LanguageClient, type LanguageClientOptions, type ServerOptions } from "vscode-languageclient/node";

const run = promisify(execFile);
const LANGUAGES = ["urdf", "xacro", "srdf", "sdf", "mjcf"];
/** Largest page, bytes: meshes are in it. */
const MOST = 512 * 2 ** 20;
/** The cursor rests this long before the page follows, ms. */
const REST = 60;

let client: LanguageClient | undefined;
let explorer: Explorer | undefined;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
    const command = (name: string, work: (uri: vscode.Uri) => Promise<void>) =>
        vscode.commands.registerCommand(name, async (given?: unknown) => {
            const uri = typeof given === "string" ? vscode.Uri.parse(given) : vscode.window.activeTextEditor?.document.uri;
            if (!uri) {
                void vscode.window.showErrorMessage("Open a robot description first.");
                return;
            }
            try {
                await work(uri);
            } catch (error) {
                void vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
            }
        });
    context.subscriptions.push(
        command("denavit.showTable", (uri) => shown("denavit.server.table", uri, "plaintext")),
        command("denavit.compareWithHead", (uri) => shown("denavit.server.compareWithHead", uri, "markdown")),
        command("denavit.showExplorer", async (uri) => {
            explorer ??= new Explorer(() => (explorer = undefined));
            await explorer.show(uri);
        }),
        vscode.commands.registerCommand("denavit.restart", async () => {
            await client?.stop();
            await started();
        }),
        vscode.workspace.onDidChangeConfiguration(async (event) => {
            if (event.affectsConfiguration("denavit.path")) {
                await client?.stop();
                await started();
            } else if (event.affectsConfiguration("denavit")) {
                await client?.sendNotification("workspace/didChangeConfiguration", { settings: { denavit: settings() } });
            }
        }),
        vscode.window.onDidChangeTextEditorSelection((event) => explorer?.follow(event.textEditor)),
        vscode.workspace.onDidSaveTextDocument((document) => void explorer?.saved(document.uri)),
    );
    await started();
}

export async function deactivate(): Promise<void> {
    await client?.stop();
}

function settings(): Record<string, unknown> {
    const own = vscode.workspace.getConfiguration("denavit");
    return {
        convention: own.get<string>("convention"),
        xacroArguments: own.get<Record<string, string | string[]>>("xacroArguments", {}),
        packagePath: own.get<string[]>("packagePath", []),
        allowAnyFile: own.get<boolean>("allowAnyFile", false),
    };
}

function program(): string {
    return vscode.workspace.getConfiguration("denavit").get<string>("path", "denavit");
}

async function started(): Promise<void> {
    const server: ServerOptions = { command: program(), args: ["lsp"] };
    const options: LanguageClientOptions = {
        documentSelector: LANGUAGES.map((language) => ({ scheme: "file", language })),
        initializationOptions: settings(),
        synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{urdf,xacro,srdf,sdf,mjcf,yaml,stl,dae,obj}") },
    };
    client = new LanguageClient("denavit", "denavit", server, options);
    // The results of commands are shown here, not as messages.
    client.registerFeature({
        fillClientCapabilities: (capabilities) => {
            capabilities.experimental = { ...(capabilities.experimental as object | undefined), denavit: true };
        },
        initialize: () => {},
        getState: () => ({ kind: "static" }),
        clear: () => {},
    });
    try {
        await client.start();
    } catch (error) {
        const words = error instanceof Error ? error.message : String(error);
        void vscode.window.showErrorMessage(`${program()} lsp does not start: ${words}. Install denavit, or set denavit.path.`);
    }
}

/** Runs a command of the server and shows its text beside the file. */
async function shown(name: string, uri: vscode.Uri, language: string): Promise<void> {
    const text: unknown = await client?.sendRequest("workspace/executeCommand", { command: name, arguments: [uri.toString()] });
    if (typeof text !== "string") return;
    const document = await vscode.workspace.openTextDocument({ content: text, language });
    await vscode.window.showTextDocument(document, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true });
}

/** The arguments of a xacro file, as the server takes them. */
function argumentsOf(file: string): string[] {
    const all = vscode.workspace.getConfiguration("denavit").get<Record<string, string | string[]>>("xacroArguments", {});
    const own = Object.entries(all).filter(([name]) => name === "*" || file === name || file.endsWith(`/${name}`));
    return own.flatMap(([, words]) => (typeof words === "string" ? words.split(/\s+/) : words)).filter((word) => word.includes(":="));
}

/** The page of `denavit explore` beside the file, on which the link under the cursor lights up. */
class Explorer {
    private readonly panel: vscode.WebviewPanel;
    private uri: vscode.Uri | undefined;
    private rest: NodeJS.Timeout | undefined;

    constructor(closed: () => void) {
        this.panel = vscode.window.createWebviewPanel("denavit.explorer", "Robot", { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true }, { enableScripts: true, retainContextWhenHidden: true, localResourceRoots: [] });
        this.panel.onDidDispose(closed);
    }

    async show(uri: vscode.Uri): Promise<void> {
        this.uri = uri;
        const folder = await mkdtemp(join(tmpdir(), "denavit-"));
        try {
            const page = join(folder, "page.html");
            const packages = vscode.workspace.getConfiguration("denavit").get<string[]>("packagePath", []).flatMap((path) => ["--package-path", path]);
            const file = uri.fsPath;
            const words = file.endsWith(".xacro") ? argumentsOf(file) : [];
            await run(program(), ["explore", file, ...words, ...packages, "-o", page], { maxBuffer: MOST });
            this.panel.title = file.split(/[/\\]/).at(-1) ?? "Robot";
            this.panel.webview.html = await readFile(page, "utf8");
        } finally {
            await rm(folder, { recursive: true, force: true });
        }
    }

    /** The page shows what is saved. */
    async saved(uri: vscode.Uri): Promise<void> {
        if (this.uri && LANGUAGES.some((language) => uri.path.endsWith(`.${language}`))) {
            await this.show(this.uri).catch(() => {
                // What is wrong is among the problems; the page keeps what it has.
            });
        }
    }

    follow(editor: vscode.TextEditor): void {
        clearTimeout(this.rest);
        this.rest = setTimeout(() => void this.light(editor), REST);
    }

    private async light(editor: vscode.TextEditor): Promise<void> {
        if (!LANGUAGES.includes(editor.document.languageId)) return;
        const place = { textDocument: { uri: editor.document.uri.toString() }, position: editor.selection.active };
        const link: unknown = await client?.sendRequest("denavit/linkAt", place);
        await this.panel.webview.postMessage({ denavit: "link", link: typeof link === "string" ? link : null });
    }
}
