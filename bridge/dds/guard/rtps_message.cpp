#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

std::string_view to_text(RtpsFault fault) {
  switch (fault) {
    case RtpsFault::kHeader: return "HEADER";
    case RtpsFault::kSubmessage: return "SUBMESSAGE";
    case RtpsFault::kOrder: return "ORDER";
    case RtpsFault::kSequenceNumber: return "SEQUENCE_NUMBER";
    case RtpsFault::kBitmap: return "BITMAP";
    case RtpsFault::kGap: return "GAP";
    case RtpsFault::kFragment: return "FRAGMENT";
    case RtpsFault::kSampleSize: return "SAMPLE_SIZE";
    case RtpsFault::kParameterList: return "PARAMETER_LIST";
    case RtpsFault::kParameter: return "PARAMETER";
    case RtpsFault::kEncapsulation: return "ENCAPSULATION";
    case RtpsFault::kService: return "SERVICE";
    case RtpsFault::kSender: return "SENDER";
    case RtpsFault::kParticipants: return "PARTICIPANTS";
    case RtpsFault::kJoinRate: return "JOIN_RATE";
    case RtpsFault::kEndpoints: return "ENDPOINTS";
    case RtpsFault::kFragmentMemory: return "FRAGMENT_MEMORY";
  }
  return "UNKNOWN";
}

}  // namespace fieldcast
