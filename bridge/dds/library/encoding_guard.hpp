// Prevents an abort of Fast DDS with DDS Security that protects whole messages: 2.9.1 and 3.1.2
// assert if they encode a message without receivers (SecurityManager::encode_rtps_message). The
// thread that repeats samples releases their writer before it sends its last message
// (FlowControllerImpl::run), and the last reader may leave at that moment. A station that leaves
// could end the bridge. The linker resolves that function by name, so the definition here is used:
// it drops messages without receivers and passes all others on. A library that hides the function,
// as one built from eprosima's source may, is not changed.
#pragma once

namespace fieldcast {

// Looks up the library's own function. Call it before the first participant; repeats do nothing.
void guard_encoding();

// The function's name for the linker.
[[nodiscard]] const char* encode_symbol();

}  // namespace fieldcast
