/* The names of the version of the standard that a fuzzer is built for, FUZZ_FMI: both share what they can. */
#ifndef FUZZ_FMI_H
#define FUZZ_FMI_H

#if FUZZ_FMI == 3
#include <fmi3Functions.h>
#define FMI(name) fmi3##name
#define FMI_STATE(verb) fmi3##verb##FMUState
#define FMI_STATE_SIZE fmi3SerializedFMUStateSize
#define FMI_DESERIALIZE fmi3DeserializeFMUState
#define FMI_RATES fmi3GetContinuousStateDerivatives
typedef fmi3Instance fmi_instance;
typedef fmi3FMUState fmi_state;
#else
#include <fmi2Functions.h>
#define FMI(name) fmi2##name
#define FMI_STATE(verb) fmi2##verb##FMUstate
#define FMI_STATE_SIZE fmi2SerializedFMUstateSize
#define FMI_DESERIALIZE fmi2DeSerializeFMUstate
#define FMI_RATES fmi2GetDerivatives
typedef fmi2Component fmi_instance;
typedef fmi2FMUstate fmi_state;
#endif

typedef FMI(Status) fmi_status;

#endif
