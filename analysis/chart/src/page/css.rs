//! The style sheet of the report.

use super::section::CHOICES;
use crate::{rules, variables};

const LIGHT: &str = "--page:#f4f5f7;--rule:#d9dde2;--soft:#f7f8fa;--link:#005a8c;--warn:#fff4e0;--warn-rule:#e69f00;--ok:#eaf4fb;--ok-rule:#0072b2;";
const DARK: &str = "--page:#0f1114;--rule:#353b42;--soft:#1e2227;--link:#7cc0ee;--warn:#33270f;--warn-rule:#f0b63c;--ok:#13283a;--ok-rule:#4fa8e0;";

const LAYOUT: &str = "\
*{box-sizing:border-box}\
body{margin:0 auto;max-width:1360px;padding:0 0 40px;background:var(--page);color:var(--tr-ink);\
font:15px/1.55 system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,sans-serif;overflow-wrap:break-word}\
header,section,nav,footer{background:var(--tr-paper);padding:10px 40px;border:1px solid var(--rule);border-top-width:0}\
header{padding-top:28px;border-top:4px solid var(--ok-rule)}\
h1{font-size:28px;line-height:1.2;margin:0 0 12px;font-weight:650;letter-spacing:-.01em}\
h2{font-size:20px;line-height:1.3;margin:4px 0 8px;font-weight:650}\
h2 .n{color:var(--tr-muted);font-weight:400;margin-right:10px}\
p{margin:0 0 8px;max-width:72ch}.lead{font-size:17px;line-height:1.5;max-width:100ch}\
a{color:var(--link)}\
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(168px,1fr));gap:1px;margin:0;background:var(--rule);\
border:1px solid var(--rule);border-top:0}\
.tiles div{background:var(--tr-paper);padding:12px 20px}\
.tiles dt{font-size:13px;color:var(--tr-muted)}.tiles dd{margin:2px 0 0;font-size:25px;line-height:1.25;font-weight:600;font-variant-numeric:tabular-nums}\
.tiles .note{font-size:13px;font-weight:400;line-height:1.4;color:var(--tr-muted)}\
nav h2{font-size:15px;margin:0 0 4px}nav ol{margin:0;padding-left:22px;columns:2;column-gap:32px}nav li{break-inside:avoid}\
figure{margin:4px 0 6px}figcaption{font-size:14px;color:var(--tr-muted);margin-top:6px;max-width:80ch}\
.blocks{display:grid;grid-template-columns:minmax(0,1fr);gap:0 32px;align-items:start}\
@media (min-width:1240px){.blocks{grid-template-columns:repeat(2,minmax(0,1fr))}.blocks>.wide,.blocks>.scroll:only-child,.blocks>.scroll:last-child:nth-child(odd){grid-column:1/-1}section>p,section>ul{max-width:none}section>ul,.fold>ul{columns:3;column-gap:32px;font-size:13px}nav ol{columns:4}}\
.choice{margin:12px 0 0}.choice>.panel{display:none}.choice>.panel>figure{margin-top:8px}\
.choice>input{position:absolute;opacity:0}.choice>label{display:inline-block;margin:0 4px 4px 0;padding:2px 10px;font-size:13px;\
border:1px solid var(--rule);border-radius:4px;cursor:pointer}.choice>input:focus-visible+label{outline:2px solid var(--link)}\
.fold>input{position:absolute;opacity:0}.fold>label{cursor:pointer;color:var(--link)}.fold>label::after{content:' \u{25b8}'}\
.fold>input:checked+label::after{content:' \u{25be}'}.fold>input:focus-visible+label{outline:2px solid var(--link)}.fold>input:not(:checked)~ul{display:none}\
figcaption b{color:var(--tr-ink);font-weight:600}\
.chart{overflow-x:auto}.chart>svg{display:block;width:100%;min-width:560px;height:auto}\
.scroll{overflow:auto;max-height:350px;margin:6px 0 8px;container-type:inline-size}.scroll>table{margin:0}.scroll thead th{position:sticky;top:0;background:var(--tr-paper)}\
table{border-collapse:collapse;font-size:14px;margin:0 0 8px;font-variant-numeric:tabular-nums}\
caption{text-align:left;font-weight:600;padding:0 0 6px}caption>span{display:block;position:sticky;left:0;width:max-content;max-width:100cqw}\
th,td{text-align:left;padding:3px 14px 3px 0;border-bottom:1px solid var(--rule);vertical-align:top}\
thead th{font-weight:600;border-bottom:2px solid var(--rule);white-space:nowrap}\
tbody th{font-weight:400}\
.num{text-align:right}\
details{margin-top:6px;font-size:14px}summary{cursor:pointer;color:var(--link);width:max-content}\
details .scroll{max-height:360px;overflow:auto;margin-top:8px;padding:0 12px;background:var(--soft);border:1px solid var(--rule)}\
details table{font-size:13px;margin:0}details thead th{position:sticky;top:0;background:var(--soft)}\
details p{margin:8px 0 0;font-size:13px;color:var(--tr-muted)}\
.remark{padding:7px 16px;margin:0 0 9px;border-left:4px solid var(--ok-rule);background:var(--ok);max-width:none}\
.warning{border-left-color:var(--warn-rule);background:var(--warn)}\
footer{font-size:13px;color:var(--tr-muted)}footer h2{font-size:15px;color:var(--tr-ink)}footer table{font-size:13px}\
code{font:12.5px/1.5 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;overflow-wrap:anywhere}\
@media (max-width:640px){header,section,nav,footer{padding:20px 16px}nav ol{columns:1}}";

const PRINT: &str = "\
@page{margin:14mm}\
body{max-width:none;background:none;font-size:10.5pt}header,section,nav,footer{border:0;padding:8px 0}\
figure,.tiles,tr,.remark,.scroll{break-inside:avoid}h2{break-after:avoid}details{display:none}table,.scroll>table{font-size:7.5pt}th,td{padding-right:6px;overflow-wrap:break-word}.num{white-space:nowrap}thead th,thead th.num{white-space:normal}.wide>table{font-size:6.5pt}\
.blocks{display:block}.choice>input,.choice>label{display:none}.fold>input:not(:checked)~ul{display:block}.fold>label::after{content:none}.choice>.panel{display:block}\
.chart,.scroll{overflow:visible;max-height:none}.chart>svg{min-width:0}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}";

/// The figure and the name of the radio button that is set, for every place that a choice has.
fn choices() -> String {
    let rule = |k: usize| {
        format!(
            ".choice>input:nth-of-type({k}):checked~.panel:nth-of-type({k}){{display:block}}\
             .choice>input:nth-of-type({k}):checked~label:nth-of-type({k}){{background:var(--ok);border-color:var(--ok-rule)}}"
        )
    };
    (1..=CHOICES).map(rule).collect()
}

/// Light unless the reader's system or `<html data-theme="dark">` asks for dark; prints light.
pub(super) fn sheet() -> String {
    let (light, dark) = (format!("{}{LIGHT}", variables(false)), format!("{}{DARK}", variables(true)));
    format!(
        ":root{{color-scheme:light dark;{light}}}\
         @media (prefers-color-scheme:dark){{:root:not([data-theme=light]){{{dark}}}}}\
         :root[data-theme=dark]{{color-scheme:dark;{dark}}}:root[data-theme=light]{{color-scheme:light}}\
         {rules}{LAYOUT}{choices}@media print{{:root,:root[data-theme=dark],:root:not([data-theme=light]){{color-scheme:light;{light}}}{PRINT}}}",
        rules = rules(),
        choices = choices()
    )
}
