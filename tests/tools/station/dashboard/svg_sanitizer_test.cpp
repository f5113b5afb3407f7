#include "tools/station/dashboard/svg_sanitizer.hpp"

#include <gtest/gtest.h>

#include "tools/station/dashboard/svg_values.hpp"

namespace fieldcast::web {
namespace {

constexpr const char* kHead = R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 20">)";
constexpr const char* kResultHead =
    R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 20">)";

// The content of a picture after the sanitiser, without its root element.
std::string inside(const std::string& content) {
  const auto made = sanitized_svg(kHead + content + "</svg>");
  if (!made) return "refused: " + made.error();
  const std::string& text = made->text;
  EXPECT_TRUE(text.starts_with(kResultHead) && text.ends_with("</svg>")) << text;
  return text.substr(std::string_view(kResultHead).size(),
                     text.size() - std::string_view(kResultHead).size() - 6);
}

std::string svg_fault_of(const std::string& text) {
  const auto made = sanitized_svg(text);
  return made ? "accepted: " + made->text : made.error();
}

TEST(SvgSanitizer, DrawingIsKept) {
  EXPECT_EQ(
      inside("<g id='tank' transform='translate(1 2) rotate(45)'>"
             "<path d='M0 0 L 1-1.5e2z' fill='url(#fade)' stroke='#12abEF'/>"
             "<text x='1' y='2' font-family='Noto Sans, \"Arial\"'>Öl &amp; Wasser</text></g>"),
      "<g id=\"tank\" transform=\"translate(1 2) rotate(45)\">"
      "<path d=\"M0 0 L 1-1.5e2z\" fill=\"url(#fade)\" stroke=\"#12abEF\"></path>"
      "<text font-family=\"Noto Sans, &quot;Arial&quot;\" x=\"1\" y=\"2\">Öl &amp; Wasser"
      "</text></g>");
}

TEST(SvgSanitizer, StyleBecomesCheckedAttributes) {
  EXPECT_EQ(inside("<rect style='fill:#fff; stroke : red;-inkscape-x:1;fill-opacity:0.5' "
                   "fill='blue'/>"),
            "<rect fill=\"#fff\" fill-opacity=\"0.5\" stroke=\" red\"></rect>");
  for (const char* style :
       {"fill:url(http://evil/x)", "stroke:url(javascript:alert(1))", "background:url(//evil)",
        "behavior:url(x.htc)", "@import 'x'", ":;;;", "fill", "fill:", "-moz-binding:url(x)"})
    EXPECT_EQ(inside("<rect style=\"" + std::string(style) + "\"/>"),
              std::string(style) == "fill:" ? "<rect fill=\"\"></rect>" : "<rect></rect>")
        << style;
}

TEST(SvgSanitizer, NothingThatRunsOrLoadsIsKept) {
  const std::string cases[] = {
      "<script>alert(1)</script>",
      "<script href='data:text/javascript,alert(1)'/>",
      "<style>@import url(http://evil)</style>",
      "<foreignObject><body xmlns='http://www.w3.org/1999/xhtml'><script/></body></foreignObject>",
      "<image href='http://evil/x.png'/>",
      "<image href='data:image/svg+xml;base64,PHN2Zy8+'/>",
      "<use href='http://evil/x.svg#a'/>",
      "<use href='#a'/>",
      "<a href='javascript:alert(1)'><text>x</text></a>",
      "<animate attributeName='href' to='javascript:alert(1)'/>",
      "<set attributeName='onmouseover' to='alert(1)'/>",
      "<iframe src='http://evil'/>",
      "<filter id='f'><feImage href='http://evil'/></filter>",
      "<pattern id='p'/>",
      "<mask id='m'/>",
      "<marker id='m'/>",
      "<h:script xmlns:h='http://www.w3.org/1999/xhtml'>alert(1)</h:script>",
      "<svg:script xmlns:svg='http://www.w3.org/2000/svg'>alert(1)</svg:script>",
      "<SCRIPT>alert(1)</SCRIPT>",
      "<sodipodi:namedview/>",
      "<!-- <script> -->",
  };
  for (const std::string& one : cases) EXPECT_EQ(inside(one), "") << one;
}

TEST(SvgSanitizer, AttributesThatRunOrLoadAreNotKept) {
  const std::string cases[] = {
      "onload='alert(1)'",
      "onclick=\"alert(1)\"",
      "ONLOAD='alert(1)'",
      "href='#a onload'",
      "href='javascript:alert(1)'",
      "xlink:href='http://evil'",
      "fill='url(http://evil)'",
      "fill='url(//evil)'",
      "fill='url(x.svg#a)'",
      "fill='u\\72l(#a)'",
      "fill='URL(#a) url(x)'",
      "fill='image-set(x)'",
      "fill='var(--x)'",
      "fill='expression(1)'",
      "fill='&#117;rl(http://evil)'",
      "clip-path='url(#a) url(x.svg)'",
      "filter='url(#a)'",
      "mask='url(#a)'",
      "font-family='x;background:url(y)'",
      "id='a\"b'",
      "class='x'",
      "xml:base='http://evil/'",
      "xmlns='http://evil/'",
      "xmlns:x='http://evil/'",
      "data-x='1'",
      "tabindex='0'",
  };
  for (const std::string& one : cases)
    EXPECT_EQ(inside("<rect " + one + "/>"), "<rect></rect>") << one;
}

TEST(SvgSanitizer, TextCannotBecomeMarkup) {
  EXPECT_EQ(inside("<title>&lt;script&gt;alert(1)&lt;/script&gt;</title>"),
            "<title>&lt;script&gt;alert(1)&lt;/script&gt;</title>");
  EXPECT_EQ(inside("<desc><![CDATA[</svg><script>alert(1)</script>]]></desc>"),
            "<desc>&lt;/svg&gt;&lt;script&gt;alert(1)&lt;/script&gt;</desc>");
  EXPECT_EQ(inside("<text>&evil; \xe2\x80\xae x</text>"), "<text>&amp;evil; \\u202E x</text>");
  EXPECT_EQ(inside("<g>loose text</g>"), "<g></g>");
}

TEST(SvgSanitizer, ClipPathCannotReferToClipPaths) {
  EXPECT_EQ(inside("<clipPath id='a'><rect clip-path='url(#a)' width='1'/></clipPath>"),
            "<clipPath id=\"a\"><rect width=\"1\"></rect></clipPath>");
  EXPECT_EQ(inside("<clipPath id='a' clip-path='url(#b)'/>"), "<clipPath id=\"a\"></clipPath>");
  EXPECT_EQ(inside("<g clip-path='url(#a)'/>"), "<g clip-path=\"url(#a)\"></g>");
}

TEST(SvgSanitizer, ChainOfGradientsHasAnEnd) {
  std::string chain;
  for (std::size_t i = 0; i <= kMaxSvgReferences; ++i)
    chain +=
        "<linearGradient href='#g" + std::to_string(i + 1) + "' id='g" + std::to_string(i) + "'/>";
  const std::string kept = inside(chain);
  EXPECT_NE(kept.find("href=\"#g500\" id=\"g499\""), std::string::npos);
  EXPECT_EQ(kept.find("href=\"#g501\""), std::string::npos);
}

TEST(SvgSanitizer, EntitiesAreRefused) {
  EXPECT_EQ(svg_fault_of("<!DOCTYPE svg [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]>" +
                         std::string(kHead) + "<text>&b;</text></svg>"),
            "the SVG declares entities, which are not allowed; save it as plain SVG");
  EXPECT_EQ(svg_fault_of("<!DOCTYPE svg [<!ENTITY x SYSTEM \"file:///etc/passwd\">]>" +
                         std::string(kHead) + "<text>&x;</text></svg>"),
            "the SVG declares entities, which are not allowed; save it as plain SVG");
}

TEST(SvgSanitizer, DocumentTypeIsDropped) {
  const auto made = sanitized_svg(
      "<?xml version=\"1.0\"?><!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" "
      "\"http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd\">" +
      std::string(kHead) + "</svg>");
  ASSERT_TRUE(made) << made.error();
  EXPECT_EQ(made->text, std::string(kResultHead) + "</svg>");
}

TEST(SvgSanitizer, TooManyElementsAndLevelsAreRefused) {
  std::string wide, deep;
  for (std::size_t i = 0; i < kMaxSvgElements; ++i) wide += "<g/>";
  EXPECT_TRUE(svg_fault_of(kHead + wide + "</svg>").starts_with("line 1: at most 20000 elements"));
  for (int i = 0; i < 80; ++i) deep += "<g>";
  const std::string closed = [] {
    std::string text;
    for (int i = 0; i < 80; ++i) text += "</g>";
    return text;
  }();
  EXPECT_TRUE(svg_fault_of(kHead + deep + closed + "</svg>").starts_with("line 1: at most"));
  std::string deepest;
  for (int i = 0; i < 100'000; ++i) deepest += "<g>";
  EXPECT_EQ(svg_fault_of(kHead + deepest), "line 1: the SVG is not well-formed XML");
}

TEST(SvgSanitizer, OtherDocumentsAreRefused) {
  for (const char* text : {"", "hello", "<html><svg/></html>", "<svg", "<svg></g>", "<?xml?>"})
    EXPECT_FALSE(sanitized_svg(text)) << text;
  EXPECT_FALSE(sanitized_svg(kHead + std::string("<?xml-stylesheet href='x.css'?></svg>")));
  EXPECT_FALSE(sanitized_svg(std::string("\xff\xfe<\0s\0v\0g\0", 10)));
  EXPECT_EQ(svg_fault_of("<svg:svg xmlns:svg='http://www.w3.org/2000/svg' viewBox='0 0 1 1'/>"),
            "the document is not an SVG; its first element must be <svg>");
}

TEST(SvgSanitizer, SizeIsThatOfTheViewBox) {
  const auto size = [](const std::string& attributes) {
    const auto made = sanitized_svg("<svg " + attributes + "/>");
    return made ? std::pair(made->width, made->height) : std::pair(0.0, 0.0);
  };
  EXPECT_EQ(size("viewBox='0,0, 300 150' width='10'"), std::pair(300.0, 150.0));
  EXPECT_EQ(size("width='30mm' height='12.5mm'"), std::pair(30.0, 12.5));
  for (const char* none :
       {"", "width='100%' height='100%'", "viewBox='0 0 0 10'", "viewBox='0 0 -1 10'",
        "viewBox='0 0 1e300 1'", "viewBox='a'", "viewBox='0 0 1 nan'", "viewBox='0 0 1 2 3'"})
    EXPECT_EQ(size(none), std::pair(0.0, 0.0)) << none;
}

TEST(SvgSanitizer, RemovedNamesAreReported) {
  const auto made = sanitized_svg(std::string(kHead) +
                                  "<script/><rect onload='x' style='behavior:url(x)'/><a/></svg>");
  ASSERT_TRUE(made);
  EXPECT_EQ(made->removed, (std::set<std::string>{"a", "onload", "script", "style behavior"}));
  std::string many;
  for (int i = 0; i < 100; ++i) many += "<x" + std::to_string(i) + "/>";
  EXPECT_EQ(sanitized_svg(kHead + many + "</svg>")->removed.size(), kMaxRemoved);
}

TEST(SvgSanitizer, ResultOfTheSanitizerIsNotChangedByIt) {
  const auto made = sanitized_svg(std::string(kHead) +
                                  "<g style='fill:red'><text>a &lt; b</text><script/></g></svg>");
  ASSERT_TRUE(made);
  const auto again = sanitized_svg(made->text);
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(again->text, made->text);
  EXPECT_TRUE(again->removed.empty());
}

}  // namespace
}  // namespace fieldcast::web
