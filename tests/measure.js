// What a browser lays out, in the title of the page: its height, how much wider it is than its window (px), what is wider than its
// place, labels that lie on each other or leave their chart, and texts whose contrast to what lies behind them is below that of
// large letters by WCAG 2.1 (3 : 1), of how many that were seen.
addEventListener('load', function () {
  var over = [], labels = [], poor = [], seen = 0;
  document.querySelectorAll('section,figure,table,.tiles>div,p,pre,h1,h2,h3').forEach(function (e) {
    if (e.clientWidth > 0 && e.scrollWidth > e.clientWidth + 1 && getComputedStyle(e).overflowX != 'auto')
      over.push(e.tagName + ' ' + e.textContent.trim().slice(0, 60)) });
  document.querySelectorAll('svg').forEach(function (s) {
    if (s.ownerSVGElement || !s.getClientRects().length) return;
    var frame = s.getBoundingClientRect();
    var texts = [...s.querySelectorAll('text')].map(function (x) { return [x.textContent, x.getBoundingClientRect(), x] })
      .filter(function (x) { return x[1].width > 0 });
    texts.forEach(function (a, i) {
      var clipped = a[2].ownerSVGElement != s;
      if (!clipped && (a[1].left < frame.left - 1 || a[1].right > frame.right + 1 || a[1].top < frame.top - 1 || a[1].bottom > frame.bottom + 1))
        labels.push(a[0] + ' leaves its chart');
      texts.slice(i + 1).forEach(function (b) {
        var w = Math.min(a[1].right, b[1].right) - Math.max(a[1].left, b[1].left);
        var h = Math.min(a[1].bottom, b[1].bottom) - Math.max(a[1].top, b[1].top);
        if (w > 2 && h > 3 && a[0] != b[0]) labels.push(a[0] + ' on ' + b[0]) }) }) });
  function rgb(c) { var m = c.match(/[0-9.]+/g); return m ? m.map(Number) : [0, 0, 0, 0] }
  function light(c) { var v = c.slice(0, 3).map(function (x) { x /= 255; return x <= 0.03928 ? x / 12.92 : Math.pow((x + 0.055) / 1.055, 2.4) });
    return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2] }
  function behind(e) { for (; e; e = e.parentElement) { var c = rgb(getComputedStyle(e).backgroundColor); if (c.length < 4 || c[3] > 0.5) return c }
    return [255, 255, 255] }
  document.querySelectorAll('h1,h2,h3,p,td,th,li,a,figcaption,summary,label,svg text').forEach(function (e) {
    if (!e.textContent.trim() || !e.getClientRects().length) return;
    seen++;
    // A label that has a colour of its own lies on a mark, which is nothing behind it here.
    if (e.closest('[fill]')) return;
    var a = light(rgb(e.closest('svg') ? getComputedStyle(e).fill : getComputedStyle(e).color)), b = light(behind(e));
    var ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 3) poor.push(e.textContent.trim().slice(0, 40) + ' ' + ratio.toFixed(1)) });
  var root = document.documentElement;
  document.title = 'MEASURED ' + JSON.stringify({ height: root.scrollHeight, wide: root.scrollWidth - root.clientWidth, over: over, labels: labels, poor: poor, seen: seen });
})
