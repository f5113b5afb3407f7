// Settings of Fast DDS that hold for the whole process, made before the first participant.
#pragma once

namespace fieldcast {

// Any thread, any number of times.
//  - Participants of one process talk through their transports like all others: the library's short cut inside a process skips
//  the
//    reliable protocol and loses what is written before both ends have matched.
//  - The library's messages go to standard error as one plain line each, instead of coloured ones to standard output, where they
//  would
//    stand between our JSON lines.
void prepare_library();

}  // namespace fieldcast
