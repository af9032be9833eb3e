/* What a process says of its own crash. */
#ifndef TREELINE_BASE_CRASH_H
#define TREELINE_BASE_CRASH_H

/* From now on SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT, where nobody handles them yet, write one
 * line to stderr before they end the process:
 *
 *     crash at address 0x10 in treeline+0x2a41f (gl_program), libOSMesa.so.8+0x51c0, ...
 *
 * the address of the fault (not of SIGABRT), then the calls, innermost first: file, offset in it as
 * `addr2line -f -e FILE OFFSET` takes it, and the function where it is known; code that was
 * generated has its address alone. */
void crash_tell(void);
/* How such a line begins. */
#define CRASH_WORD "crash "

#endif
