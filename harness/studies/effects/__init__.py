"""Which effects a scene calls for, what each costs in time, and what each changes in the answer."""


