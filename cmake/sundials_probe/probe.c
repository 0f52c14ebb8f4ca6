#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <stddef.h>

int sundials_probe(SUNContext context);

/* Refers to every part of SUNDIALS that the solver uses, so that linking pulls in all of it. */
int sundials_probe(SUNContext context)
{
    N_Vector state = N_VNew_Serial(6, context);
    void *cvode = CVodeCreate(CV_BDF, context);
    const int status = CVodeInit(cvode, NULL, 0.0, state);
    CVodeFree(&cvode);
    N_VDestroy(state);
    return status;
}
