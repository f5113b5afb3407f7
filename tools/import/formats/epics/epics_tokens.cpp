#include "tools/import/formats/epics/epics_tokens.hpp"

#include <algorithm>

namespace fieldcast::importing {

void EpicsTokens::skip_blanks() {
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (c == '#') at_ = std::min(text_.find('\n', at_), text_.size() - 1);
    if (text_[at_] == '\n') {
      ++line_;
    } else if (text_[at_] != ' ' && text_[at_] != '\t' && c != '#') {
      return;
    }
  }
}

std::optional<EpicsToken> EpicsTokens::next() {
  skip_blanks();
  if (at_ >= text_.size()) return std::nullopt;
  EpicsToken token{.text = {}, .line = line_};
  if (std::string_view("{}(),").find(text_[at_]) != std::string_view::npos) {
    token.text = text_[at_++];
    return token;
  }
  if (text_[at_] == '"') {
    token.quoted = true;
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      if (text_[at_] == '\n') ++line_;
      token.text += text_[at_];
    }
    if (at_ < text_.size()) ++at_;
    return token;
  }
  // The brackets of a macro are part of the word: $(P)$(R).
  std::size_t open = 0;
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    const bool macro = (c == '(' || c == '{') && at_ > 0 && text_[at_ - 1] == '$';
    if (macro) {
      ++open;
    } else if (open > 0 && (c == ')' || c == '}')) {
      --open;
    } else if (c == '\n' ||
               (open == 0 && std::string_view(" \t\"{}(),#").find(c) != std::string_view::npos)) {
      break;
    }
    token.text += c;
  }
  return token;
}

}  // namespace fieldcast::importing
