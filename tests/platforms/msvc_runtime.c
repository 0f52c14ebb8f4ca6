/* What a compiler in the mode of Microsoft's wants of Microsoft's runtime, for gcc of mingw-w64. */

/* That floating point is used. */
int _fltused;

/* Touches the pages of a large frame, which the caller then takes: gcc's own of another name does so too. Its
 * ___chkstk takes the frame as well. */
__asm__(".text\n.globl __chkstk\n__chkstk:\n\tjmp ___chkstk_ms\n");
