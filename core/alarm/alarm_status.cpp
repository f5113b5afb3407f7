#include "core/alarm/alarm_status.hpp"

namespace fieldcast {

std::string to_text(const AlarmKey& key) {
  std::string text = key.bus + '/' + key.device;
  if (!key.channel.empty()) text += '/' + key.channel + ' ' + std::string(to_text(key.limit));
  return text;
}

std::string_view to_text(AlarmStage stage) {
  switch (stage) {
    case AlarmStage::kClear: return "clear";
    case AlarmStage::kUnacknowledged: return "unacknowledged";
    case AlarmStage::kAcknowledged: return "acknowledged";
    case AlarmStage::kReturned: return "returned";
  }
  return "?";
}

std::string_view to_text(AlarmActionKind kind) {
  switch (kind) {
    case AlarmActionKind::kAcknowledge: return "acknowledge";
    case AlarmActionKind::kShelve: return "shelve";
    case AlarmActionKind::kUnshelve: return "unshelve";
    case AlarmActionKind::kMaintenance: return "maintenance";
    case AlarmActionKind::kEndMaintenance: return "end maintenance";
  }
  return "?";
}

}  // namespace fieldcast
