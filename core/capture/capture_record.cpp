#include "core/capture/capture_record.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

namespace {

void add_line(std::string& comment, const std::string& line) {
  if (line.empty()) return;
  if (!comment.empty()) comment += '\n';
  comment += line;
}

void cut(std::string& text, std::size_t limit) {
  if (text.size() <= limit) return;
  while (limit > 0 && (static_cast<unsigned char>(text[limit]) & 0xC0) == 0x80) --limit;
  text.resize(limit);
}

}  // namespace

void FrameGatherer::take(CaptureRecord record, std::vector<CapturedFrame>& out) {
  // The capture began during an exchange: only the end of its response was recorded.
  if (record.kind != CaptureRecord::Kind::kReceived && !std::exchange(begun_, true) &&
      std::exchange(response_, std::nullopt) && record.kind == CaptureRecord::Kind::kRemark)
    return;
  switch (record.kind) {
    case CaptureRecord::Kind::kSent: return take_sent(std::move(record), out);
    case CaptureRecord::Kind::kReceived: return take_received(std::move(record), out);
    case CaptureRecord::Kind::kRemark: return remark(record.text, out);
    case CaptureRecord::Kind::kEnded:
      if (!in_flight_) return;  // unsolicited bytes end with a remark, or after kQuiet
      give_request(out);
      give_response(out);
      in_flight_ = false;
      return;
  }
}

void FrameGatherer::take_sent(CaptureRecord record, std::vector<CapturedFrame>& out) {
  const bool continues = record.session && request_ && request_->session &&
                         !is_over(*request_, record.at) &&
                         request_->bytes.size() + record.bytes.size() <= kMaxFrame;
  if (continues) {
    request_->at = record.at;
    append(request_->bytes, record.bytes);
    append(echo_, record.bytes);
    return;
  }
  give_request(out);
  give_response(out);
  device_ = record.device;
  in_flight_ = !record.session;
  echo_ = record.bytes;
  request_ = CapturedFrame{
      record.at,     Direction::kSent, device_, std::move(record.bytes), std::move(record.text),
      record.session};
}

void FrameGatherer::take_received(CaptureRecord record, std::vector<CapturedFrame>& out) {
  give_request(out);
  if (response_ && !in_flight_ && is_over(*response_, record.at)) give_response(out);
  if (!response_)
    response_ = CapturedFrame{record.at, Direction::kReceived, device_, {}, {}, record.session};
  response_->at = record.at;
  append(response_->bytes, record.bytes);
  // Equal bytes alone may be the response of a device that repeats the request.
  if (!echo_.empty() && response_->bytes.size() > echo_.size() &&
      std::equal(echo_.begin(), echo_.end(), response_->bytes.begin())) {
    give({record.at, Direction::kSent, device_, echo_, std::string(kEchoComment), record.session},
         out);
    response_->bytes.erase(response_->bytes.begin(),
                           response_->bytes.begin() + static_cast<std::ptrdiff_t>(echo_.size()));
    echo_.clear();
  }
  while (response_->bytes.size() > kMaxFrame) {
    CapturedFrame part = *response_;
    part.bytes.resize(kMaxFrame);
    response_->bytes.erase(response_->bytes.begin(), response_->bytes.begin() + kMaxFrame);
    give(std::move(part), out);
  }
}

void FrameGatherer::remark(const std::string& text, std::vector<CapturedFrame>& out) {
  if (response_) {
    add_line(response_->comment, text);
    give_response(out);
  } else if (request_) {
    add_line(request_->comment, text);
    give_request(out);
  } else if (note_.size() < kMaxComment) {
    add_line(note_, text);
  }
  in_flight_ = false;
}

void FrameGatherer::lost(std::uint64_t records, std::vector<CapturedFrame>& out) {
  flush(out);
  in_flight_ = false;
  echo_.clear();
  add_line(note_, std::to_string(records) +
                      " pieces are missing before this frame: the capture was too slow for them");
}

void FrameGatherer::look(UtcTime now, std::vector<CapturedFrame>& out) {
  if (in_flight_) return;
  if (request_ && is_over(*request_, now)) give_request(out);
  if (response_ && is_over(*response_, now)) give_response(out);
}

bool FrameGatherer::is_over(const CapturedFrame& frame, UtcTime now) {
  const Duration quiet = frame.session ? kQuietOfSession : kQuiet;
  return now.nanoseconds - frame.at.nanoseconds > quiet.count();
}

void FrameGatherer::flush(std::vector<CapturedFrame>& out) {
  give_request(out);
  give_response(out);
}

void FrameGatherer::give_request(std::vector<CapturedFrame>& out) {
  if (!request_) return;
  give(std::move(*request_), out);
  request_.reset();
}

void FrameGatherer::give_response(std::vector<CapturedFrame>& out) {
  if (response_ && !response_->bytes.empty()) give(std::move(*response_), out);
  response_.reset();
}

void FrameGatherer::give(CapturedFrame frame, std::vector<CapturedFrame>& out) {
  if (!note_.empty()) {
    add_line(note_, frame.comment);
    frame.comment = std::exchange(note_, {});
  }
  cut(frame.comment, kMaxComment);
  out.push_back(std::move(frame));
}

}  // namespace fieldcast
