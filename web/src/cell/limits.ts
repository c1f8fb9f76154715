/** Messages of one request at most; the worker sends three. */
export const MOST_MESSAGES = 100;
