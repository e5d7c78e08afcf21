// Search where pages are opened from a folder: browsers refuse a Worker there, so that its script runs in a hidden frame.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      const base = new URL(url, location.href);
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.body.append(this.frame);
      const inside = this.frame.contentWindow;
      inside.postMessage = undefined;
      const document_ = inside.document;
      document_.open();
      document_.write("<!doctype html><html><body></body></html>");
      document_.close();
      this.listener = null;
      inside.importScripts = (...urls) =>
        urls.reduce(
          (before, one) =>
            before.then(
              () =>
                new Promise((loaded, failed) => {
                  const script = document_.createElement("script");
                  script.src = new URL(one, base).href;
                  script.onload = loaded;
                  script.onerror = failed;
                  document_.body.append(script);
                }),
            ),
          Promise.resolve(),
        );
      inside.addEventListener_ = inside.addEventListener.bind(inside);
      inside.addEventListener = (kind, listener) => {
        if (kind === "message") this.listener = listener;
        else inside.addEventListener_(kind, listener);
      };
      inside.postMessage = (data) => {
        const event = new MessageEvent("message", {data});
        this.dispatchEvent(event);
        if (this.onmessage) this.onmessage(event);
      };
      this.ready = inside.importScripts(base.href);
    }
    postMessage(data) {
      this.ready.then(() => this.listener && this.listener(new MessageEvent("message", {data})));
    }
    terminate() {
      this.frame.remove();
    }
  };
}
